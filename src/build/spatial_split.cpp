#include "build/spatial_split.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "build/object_split.hpp"
#include "math/clip.hpp"

namespace kerf {
namespace {

// A bin holds the parts of references that lie in it, and how many of them begin and end here: the references
// left of a plane are those that entered before it, those right of it the ones that have yet to leave.
struct Bin {
  Box3f box;
  std::uint32_t entries = 0, exits = 0;
};

struct BinRange {
  int first, last;
};

// A box that ends exactly on a plane does not reach into the bin behind it.
BinRange bins_of(const Reference& reference, int axis, float origin, float scale) {
  const int first = std::clamp(static_cast<int>((reference.lower[axis] - origin) * scale), 0, bin_count - 1);
  const int last = std::clamp(static_cast<int>(std::ceil((reference.upper[axis] - origin) * scale)) - 1,
                              first, bin_count - 1);
  return {first, last};
}

float plane_before(int bin, float origin, float size) {
  return origin + size * (static_cast<float>(bin) / static_cast<float>(bin_count));
}

void fill(std::array<Bin, bin_count>& bins, const Geometry& geometry, std::span<const Reference> references,
          int axis, float origin, float size, float scale) {
  for (const Reference& reference : references) {
    const auto [first, last] = bins_of(reference, axis, origin, scale);
    ++bins[static_cast<std::size_t>(first)].entries;
    ++bins[static_cast<std::size_t>(last)].exits;
    Box3f rest = reference.bounds();
    if (first < last) {
      const Triangle triangle = geometry.triangle(reference.primitive);
      for (int bin = first; bin < last; ++bin) {
        const auto [left, right] = chop(triangle, rest, axis, plane_before(bin + 1, origin, size));
        if (!left.empty()) {
          Box3f& box = bins[static_cast<std::size_t>(bin)].box;
          box = merge(box, left);
        }
        rest = right;
      }
    }
    if (!rest.empty()) {
      Box3f& box = bins[static_cast<std::size_t>(last)].box;
      box = merge(box, rest);
    }
  }
}

}  // namespace

SpatialSplit find_spatial_split(const Geometry& geometry, std::span<const Reference> references,
                                const Box3f& box, std::uint32_t slack) {
  const auto total = static_cast<std::uint32_t>(references.size());
  SpatialSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    const float origin = box.lower[axis], size = box.upper[axis] - origin;
    const float scale = static_cast<float>(bin_count) / size;
    if (!(size > 0.0f && scale <= std::numeric_limits<float>::max())) continue;
    std::array<Bin, bin_count> bins;
    fill(bins, geometry, references, axis, origin, size, scale);

    std::array<Box3f, bin_count> right_boxes;
    Box3f side;
    for (std::size_t i = bin_count - 1; i > 0; --i) right_boxes[i] = side = merge(side, bins[i].box);
    side = {};
    std::uint32_t left = 0, right = total;
    for (std::size_t i = 1; i < bin_count; ++i) {
      side = merge(side, bins[i - 1].box);
      left += bins[i - 1].entries;
      right -= bins[i - 1].exits;
      if (left == 0 || right == 0 || left + right - total > slack) continue;
      const float cost =
          half_area(side) * static_cast<float>(left) + half_area(right_boxes[i]) * static_cast<float>(right);
      if (cost < best.cost) {
        best = {.cost = cost,
                .axis = axis,
                .plane = plane_before(static_cast<int>(i), origin, size),
                .origin = origin,
                .scale = scale,
                .first_right = static_cast<int>(i),
                .left_count = left,
                .right_count = right,
                .left = side,
                .right = right_boxes[i]};
      }
    }
  }
  return best;
}

SpatialPartition partition(const Geometry& geometry, std::span<Reference> references, Reference* spare,
                           const SpatialSplit& split) {
  // Both children as they would be if every straddling reference were divided; unsplitting grows the one and
  // takes from the other.
  Box3f left_box = split.left, right_box = split.right;
  auto left_count = static_cast<float>(split.left_count), right_count = static_cast<float>(split.right_count);

  std::uint32_t left_end = 0, right_begin = static_cast<std::uint32_t>(references.size()), spares = 0;
  while (left_end < right_begin) {
    const Reference reference = references[left_end];
    const auto [first, last] = bins_of(reference, split.axis, split.origin, split.scale);
    bool to_left = last < split.first_right;
    if (first < split.first_right && !to_left) {
      const auto [left, right] =
          chop(geometry.triangle(reference.primitive), reference.bounds(), split.axis, split.plane);
      const float divided = half_area(left_box) * left_count + half_area(right_box) * right_count;
      const Box3f grown_left = merge(left_box, reference.bounds()),
                  grown_right = merge(right_box, reference.bounds());
      const float whole_left =
          half_area(grown_left) * left_count + half_area(right_box) * (right_count - 1.0f);
      const float whole_right =
          half_area(left_box) * (left_count - 1.0f) + half_area(grown_right) * right_count;
      if (right.empty() ||
          (right_count > 1.0f && !left.empty() && whole_left <= divided && whole_left <= whole_right)) {
        if (!right.empty()) left_box = grown_left;
        right_count -= 1.0f;
        to_left = true;
      } else if (left.empty() || (left_count > 1.0f && whole_right <= divided)) {
        if (!left.empty()) right_box = grown_right;
        left_count -= 1.0f;
      } else {
        references[left_end++] = Reference(left, reference.primitive);
        spare[spares++] = Reference(right, reference.primitive);
        continue;
      }
    }
    if (to_left) {
      ++left_end;
    } else {
      std::swap(references[left_end], references[--right_begin]);
    }
  }
  return {left_end, static_cast<std::uint32_t>(references.size()) - right_begin + spares};
}

}  // namespace kerf
