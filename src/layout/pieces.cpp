#include "layout/pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/parallel.hpp"
#include "math/predicates.hpp"
#include "math/triangle.hpp"

namespace kerf {
namespace {

// A convex polygon in the barycentric coordinates of a triangle.
struct Polygon {
  struct Corner {
    double u, v;
  };
  // Three, and one more for each of the six planes of a box; rounding may bring in others.
  std::array<Corner, 16> corners{{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}};
  std::uint32_t count = 3;
};

// What is left of `polygon` where first + u * along_u + v * along_v is not negative.
Polygon cut(const Polygon& polygon, double first, double along_u, double along_v) {
  const auto height = [&](const Polygon::Corner& p) { return first + p.u * along_u + p.v * along_v; };
  Polygon rest;
  rest.count = 0;
  Polygon::Corner from = polygon.corners[polygon.count - 1];
  double from_height = height(from);
  for (std::uint32_t i = 0; i < polygon.count; ++i) {
    const Polygon::Corner to = polygon.corners[i];
    const double to_height = height(to);
    if (rest.count + 2 > rest.corners.size()) return polygon;
    if ((from_height < 0.0) != (to_height < 0.0)) {
      const double s = from_height / (from_height - to_height);
      rest.corners[rest.count++] = {from.u + s * (to.u - from.u), from.v + s * (to.v - from.v)};
    }
    if (to_height >= 0.0) rest.corners[rest.count++] = to;
    from = to;
    from_height = to_height;
  }
  return rest.count == 0 ? polygon : rest;
}

// The part of `triangle` in `box`, and a little more: heights are off by a few roundings of 2^-53 of the
// coordinates, and every plane is moved out by more than that.
Polygon clip(const Triangle& triangle, const Box3f& box) {
  const Vec3d e = difference(triangle.v1, triangle.v0), f = difference(triangle.v2, triangle.v0);
  const double along_u[3] = {e.x, e.y, e.z}, along_v[3] = {f.x, f.y, f.z};
  const Box3f whole = bounds_of(triangle);
  Polygon polygon;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = triangle.v0[axis], lower = box.lower[axis], upper = box.upper[axis];
    const double margin =
        0x1p-44 * (std::abs(double{whole.lower[axis]}) + std::abs(double{whole.upper[axis]}));
    if (whole.lower[axis] < box.lower[axis])
      polygon = cut(polygon, a - lower + margin, along_u[axis], along_v[axis]);
    if (whole.upper[axis] > box.upper[axis])
      polygon = cut(polygon, upper - a + margin, -along_u[axis], -along_v[axis]);
  }
  return polygon;
}

std::uint16_t in_steps(double weight) {
  return static_cast<std::uint16_t>(std::lround(65535.0 * std::clamp(weight, 0.0, 1.0)));
}

}  // namespace

Pieces::Pieces(const WideBvh& wide, std::size_t triangles) {
  const std::size_t words = wide.references() / 64 + 1;
  divided_.resize(words + 1);
  before_.resize(words);
  std::uint32_t count = 0;
  {
    constexpr std::uint8_t once = 1, often = 2;
    std::vector<std::uint8_t> met(triangles);
    const auto for_each_reference = [&](const auto& visit) {
      for_each_leaf(wide, [&](ChildLink leaf) {
        for (std::uint32_t i = 0; i < leaf.count(); ++i)
          visit(leaf.first() + i, met[triangle_id(wide, leaf, i)]);
      });
    };
    for_each_reference([&](std::uint32_t, std::uint8_t& times) { times = times == 0 ? once : often; });
    for_each_reference([&](std::uint32_t reference, std::uint8_t times) {
      if (times == often) divided_[reference / 64] |= std::uint64_t{1} << reference % 64;
    });
  }
  for (std::size_t word = 0; word < words; ++word) {
    before_[word] = count;
    count += static_cast<std::uint32_t>(std::popcount(divided_[word]));
  }

  first_corners_.resize(std::size_t{count} + 1);
  struct Clipped {
    std::uint32_t piece;
    Polygon polygon;
  };
  constexpr std::uint32_t nodes_per_block = 256;
  std::vector<std::vector<Clipped>> blocks((wide.node_count + nodes_per_block - 1) / nodes_per_block);
  with_width(wide.width, [&](auto width) {
    const auto* const nodes = wide.nodes<WideNode<width>>();
    parallel_for(blocks.size(), [&](std::size_t block) {
      const auto begin = static_cast<std::uint32_t>(block) * nodes_per_block;
      for (std::uint32_t n = begin; n < std::min(begin + nodes_per_block, wide.node_count); ++n) {
        for (std::uint32_t slot = 0; slot < width; ++slot) {
          const ChildLink leaf = nodes[n].children[slot];
          const Box3f box = child_box(nodes[n], slot);
          if (!leaf.is_leaf() || box.empty()) continue;
          for (std::uint32_t rest = in_leaf(leaf); rest != 0; rest &= rest - 1) {
            const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
            const Triangle triangle = triangle_in(wide, leaf, i);
            if (contains(box, bounds_of(triangle))) continue;
            const std::uint32_t piece = number(leaf.first() + i);
            blocks[block].push_back({piece, clip(triangle, box)});
            first_corners_[piece + 1] = blocks[block].back().polygon.count;
          }
        }
      }
    });
  });
  std::partial_sum(first_corners_.begin(), first_corners_.end(), first_corners_.begin());
  corners_.resize(first_corners_.back());
  parallel_for(blocks.size(), [&](std::size_t block) {
    for (const auto& [piece, polygon] : blocks[block]) {
      for (std::uint32_t i = 0; i < polygon.count; ++i) {
        const auto [u, v] = polygon.corners[i];
        corners_[first_corners_[piece] + i] = {in_steps(u), in_steps(v)};
      }
    }
  });
}

}  // namespace kerf
