#include <array>
#include <cmath>
#include <memory_resource>

#include "math/vec3f.hpp"
#include "out_of_memory.hpp"
#include "query/point_distance.hpp"
#include "query/subtrees.hpp"

namespace kerf {
namespace {

// A triangle's closest point, before it is rounded and named.
struct Candidate {
  ClosestOnTriangle closest;
  std::uint32_t id;
  Triangle triangle;

  bool before(double squared_distance, std::uint32_t other) const {
    return closest.squared_distance != squared_distance ? closest.squared_distance < squared_distance
                                                        : id < other;
  }
};

SurfacePoint surface_point(const TreeView& tree, const Candidate& candidate) {
  const auto& [closest, id, triangle] = candidate;
  const auto [u, v] = std::pair(closest.u, closest.v);
  SurfacePoint point;
  for (int axis = 0; axis < 3; ++axis) {
    point.position[axis] =
        static_cast<float>((1.0 - u - v) * triangle.v0[axis] + u * triangle.v1[axis] + v * triangle.v2[axis]);
  }
  const PrimitiveId place = tree.locate(id);
  point.distance = static_cast<float>(std::sqrt(closest.squared_distance));
  point.u = static_cast<float>(u);
  point.v = static_cast<float>(v);
  point.primitive = place.primitive;
  point.mesh = place.mesh;
  return point;
}

// Nodes nearest first, until none is left that is as near as the best triangle.
std::optional<Candidate> find_closest(const TreeView& tree, const Vec3f& point, double max_squared_distance) {
  struct Item {
    double squared_distance;
    TreeView::Node node;
  };
  const auto farther = [](const Item& a, const Item& b) { return a.squared_distance > b.squared_distance; };
  std::array<std::byte, 4096> stack;
  std::pmr::monotonic_buffer_resource memory(stack.data(), stack.size());
  std::pmr::vector<Item> queue(&memory);
  queue.reserve(stack.size() / sizeof(Item) - 1);

  std::optional<Candidate> best;
  double reach = max_squared_distance;
  const auto push = [&](TreeView::Node node, const Box3f& box) {
    const double distance = squared_distance(point, box);
    if (!(distance <= reach)) return;
    queue.push_back({distance, node});
    std::push_heap(queue.begin(), queue.end(), farther);
  };
  if (!tree.empty()) push(tree.root(), tree.bounds());
  while (!queue.empty() && queue.front().squared_distance <= reach) {
    std::pop_heap(queue.begin(), queue.end(), farther);
    const TreeView::Node node = queue.back().node;
    queue.pop_back();
    if (!tree.is_leaf(node)) {
      tree.for_each_child(node, push);
      continue;
    }
    tree.for_each_triangle(node, [&](std::uint32_t id, const Triangle& triangle) {
      if (plane_is_beyond(point, triangle, reach)) return;
      const Candidate found{closest_on_triangle(point, triangle), id, triangle};
      if (!(found.closest.squared_distance <= reach)) return;
      if (best && !found.before(best->closest.squared_distance, best->id)) return;
      best = found;
      reach = found.closest.squared_distance;
    });
  }
  return best;
}

}  // namespace

std::optional<SurfacePoint> Bvh::closest_point(const Vec3f& point, float max_distance) const {
  if (!is_finite(point) || !(max_distance >= 0.0f)) return std::nullopt;
  const TreeView tree(*structure_);
  const double reach = static_cast<double>(max_distance) * max_distance;
  const auto best = report_out_of_memory([&] { return find_closest(tree, point, reach); });
  if (!best) return std::nullopt;
  return surface_point(tree, *best);
}

std::vector<SurfacePoint> Bvh::within(const Vec3f& point, float radius) const {
  std::vector<SurfacePoint> points;
  if (!is_finite(point) || !(radius >= 0.0f)) return points;
  const TreeView tree(*structure_);
  const double reach = static_cast<double>(radius) * radius;
  report_out_of_memory([&] {
    std::vector<Candidate> found;
    for_each_leaf(
        tree, [&](const Box3f& box) { return squared_distance(point, box) <= reach; },
        [&](std::uint32_t id, const Triangle& triangle) {
          if (plane_is_beyond(point, triangle, reach)) return;
          const ClosestOnTriangle closest = closest_on_triangle(point, triangle);
          if (closest.squared_distance <= reach) found.push_back({closest, id, triangle});
        });
    std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
      return a.before(b.closest.squared_distance, b.id);
    });
    const auto same = [](const Candidate& a, const Candidate& b) { return a.id == b.id; };
    found.erase(std::unique(found.begin(), found.end(), same), found.end());
    points.reserve(found.size());
    for (const Candidate& candidate : found) points.push_back(surface_point(tree, candidate));
  });
  return points;
}

}  // namespace kerf
