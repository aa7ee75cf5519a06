// The triangles of a scene near a point.
#include "queries/points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <tuple>
#include <vector>

#include <kerf/scene.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "math/point_box.hpp"
#include "math/vec3f.hpp"
#include "queries/batches.hpp"
#include "scene/chain.hpp"
#include "scene/places.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

using Double3 = std::array<double, 3>;

Double3 operator-(const Double3& a, const Double3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Double3& a, const Double3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Double3 cross(const Double3& a, const Double3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Double3 moved(const Transform& transform, const Vec3f& p) {
  Double3 to;
  for (std::size_t i = 0; i < 3; ++i) {
    const double(&row)[4] = transform.rows[i];
    to[i] = row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3];
  }
  return to;
}

// The point a + u (b - a) + v (c - a) of a triangle that is closest to a given one.
struct Closest {
  double squared_distance, u, v;
};

// The closest of the three edges' points, or the foot of the perpendicular where that is inside.
Closest closest_on(const std::array<Double3, 3>& corner, const Double3& p) {
  Closest best{std::numeric_limits<double>::infinity(), 0.0, 0.0};
  const Double3 e = corner[1] - corner[0], f = corner[2] - corner[0], n = cross(e, f);
  bool inside = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const Double3 edge = corner[(i + 1) % 3] - corner[i], q = p - corner[i];
    const double length = dot(edge, edge);
    const double s = length > 0.0 ? std::clamp(dot(q, edge) / length, 0.0, 1.0) : 0.0;
    const Double3 off{q[0] - s * edge[0], q[1] - s * edge[1], q[2] - s * edge[2]};
    if (const double squared = dot(off, off); squared < best.squared_distance) {
      const double from = 1.0 - s;  // weights of this corner and of the next
      best = i == 0   ? Closest{squared, s, 0.0}
             : i == 1 ? Closest{squared, from, s}
                      : Closest{squared, 0.0, from};
    }
    inside = inside && dot(cross(edge, q), n) > 0.0;
  }
  const double area = dot(n, n);
  if (!inside || !(area > 0.0)) return best;
  const Double3 q = p - corner[0];
  const double height = dot(q, n);
  if (const double squared = height / area * height; squared < best.squared_distance)
    best = {squared, dot(cross(q, f), n) / area, dot(cross(e, q), n) / area};
  return best;
}

struct Found {
  double squared_distance;
  ScenePoint point;
};

bool is_nearer(const Found& a, const Found& b) {
  const auto key = [](const Found& found) {
    const ScenePoint& p = found.point;
    return std::tuple(found.squared_distance, p.instance, p.mesh, p.primitive);
  };
  return key(a) < key(b);
}

// The squared distance in an object's space within which all lies that is within `squared_reach` in the
// scene.
double reach_in_object(const Placement& placement, const Vec3f& local, double squared_reach) {
  const double reach =
      std::sqrt(squared_reach) * placement.largest_stretch() + 2.0 * placement.rounding_of(local);
  return reach * reach * (1.0 + 1e-12);
}

// The triangles of one instance.
class InstancePoints {
 public:
  InstancePoints(const Structure& object, std::uint32_t number, const Transform& transform,
                 const Placement& placement, const Vec3f& point)
      : object_(object),
        number_(number),
        transform_(transform),
        placement_(placement),
        local_(placement.to_object(point)),
        point_{point.x, point.y, point.z} {}

  // The triangle that is closest to the point in the object, which need not be in the scene.
  bool find_one(double squared_reach, Found& found) const {
    NearTriangle near;
    if (!is_finite(local_) ||
        !object_.kernels->closest_triangle(object_.wide, local_, in_object(squared_reach), near))
      return false;
    found = in_scene(near);
    return true;
  }

  // A squared distance in the scene within which `count` triangles lie; infinite if there are fewer within
  // `squared_reach`. Those that are nearest in the object need not be so in the scene.
  double reach_of(std::size_t count, double squared_reach) const {
    std::vector<NearTriangle> near;
    if (is_finite(local_)) {
      object_.kernels->nearest_triangles(object_.wide, local_, in_object(squared_reach), count, near);
    }
    if (near.size() < count) return std::numeric_limits<double>::infinity();
    double farthest = 0.0;
    for (const NearTriangle& triangle : near)
      farthest = std::max(farthest, in_scene(triangle).squared_distance);
    return farthest;
  }

  // All with a squared distance of up to `squared_reach` in the scene, some more than once.
  void append(double squared_reach, std::vector<Found>& all) const {
    if (!is_finite(local_)) return;
    std::vector<NearTriangle> near;
    object_.kernels->triangles_within(object_.wide, local_, in_object(squared_reach), near);
    for (const NearTriangle& triangle : near) {
      const Found found = in_scene(triangle);
      if (found.squared_distance <= squared_reach) all.push_back(found);
    }
  }

 private:
  double in_object(double squared_reach) const { return reach_in_object(placement_, local_, squared_reach); }

  Found in_scene(const NearTriangle& near) const {
    const Triangle t = triangle_in(object_.wide, near.leaf, near.place);
    const std::array<Double3, 3> corner{moved(transform_, t.v0), moved(transform_, t.v1),
                                        moved(transform_, t.v2)};
    const auto [squared_distance, u, v] = closest_on(corner, point_);
    const PrimitiveId id = locate(object_, near.id);
    Found found{squared_distance, {}};
    for (std::size_t i = 0; i < 3; ++i) {
      found.point.position[static_cast<int>(i)] =
          static_cast<float>((1.0 - u - v) * corner[0][i] + u * corner[1][i] + v * corner[2][i]);
    }
    found.point.distance = static_cast<float>(std::sqrt(squared_distance));
    found.point.u = static_cast<float>(u);
    found.point.v = static_cast<float>(v);
    found.point.primitive = id.primitive;
    found.point.mesh = id.mesh;
    found.point.instance = number_;
    return found;
  }

  const Structure& object_;
  const std::uint32_t number_;
  const Transform& transform_;
  const Placement& placement_;
  const Vec3f local_;
  const Double3 point_;
};

// Calls `visit(place)` for the places whose boxes are within `reach()`, a squared distance, nearest first.
template <class Reach, class Visit>
void visit_near_places(const SceneStructure& scene, const Vec3f& point, const Reach& reach,
                       const Visit& visit) {
  using Entry = std::pair<double, std::uint32_t>;  // a squared distance and a link
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  with_width(scene.top.width, [&](auto width) {
    waiting.emplace(0.0, ChildLink::node(0).bits());
    while (!waiting.empty() && waiting.top().first <= reach()) {
      const ChildLink link(waiting.top().second);
      waiting.pop();
      if (link.is_leaf()) {
        for (std::uint32_t i = link.first(); i < link.first() + link.count(); ++i) visit(scene.places[i]);
        continue;
      }
      const auto& node = scene.top.nodes<WideNode<width>>()[link.node()];
      for (std::uint32_t slot = 0; slot < width; ++slot) {
        const Box3f box = child_box(node, slot);
        if (box.empty()) continue;
        if (const double distance = squared_distance(point, box); distance <= reach())
          waiting.emplace(distance, node.children[slot].bits());
      }
    }
  });
}

// Calls `visit(instance)` for the instances that may be within `reach()`, a squared distance from the point,
// of all levels. `transform` is the way from this scene to the outermost one; null for that itself.
template <class Reach, class Visit>
void visit_near_instances(const SceneStructure& scene, const Transform* transform, std::uint32_t first,
                          const Vec3f& point, const Reach& reach, const Visit& visit) {
  if (scene.top.empty()) return;
  const auto visit_inside = [&](const SceneStructure::Place& place) {
    const Transform& inner = scene.instance_of(place).transform;
    const Transform whole = transform == nullptr ? inner : followed(inner, *transform);
    const std::uint32_t number = first + place.number;
    if (place.has_scene()) {
      visit_near_instances(place.scene(), &whole, number, point, reach, visit);
    } else if (transform == nullptr) {
      visit(InstancePoints(place.object(), number, whole, place.placement, point));
    } else {
      const Placement placement = place_object(whole, place.object().wide.bounds).placement;
      visit(InstancePoints(place.object(), number, whole, placement, point));
    }
  };
  if (transform == nullptr) {
    visit_near_places(scene, point, reach, visit_inside);
    return;
  }
  const Placement placement = place_object(*transform, scene.top.bounds).placement;
  const Vec3f local = placement.to_object(point);
  if (!is_finite(local)) return;
  visit_near_places(
      scene, local, [&] { return reach_in_object(placement, local, reach()); }, visit_inside);
}

bool has_sense(const Vec3f& point, float distance) {
  return is_finite(point) && distance >= 0.0f;
}

ScenePoint closest(const SceneStructure& scene, const Vec3f& point, float max_distance) {
  if (!has_sense(point, max_distance)) return {};
  Found best{static_cast<double>(max_distance) * max_distance, {}};
  std::vector<Found> all;
  visit_near_instances(
      scene, nullptr, 0, point, [&] { return best.squared_distance; },
      [&](const InstancePoints& instance) {
        Found found;
        if (!instance.find_one(best.squared_distance, found)) return;
        // With this one's distance as the limit, few others are left to be compared.
        all.clear();
        instance.append(std::min(found.squared_distance, best.squared_distance), all);
        for (const Found& each : all)
          if (!best.point || is_nearer(each, best)) best = each;
      });
  return best.point;
}

// Sorts them, and takes out what is in them more than once.
void put_in_order(std::vector<Found>& all) {
  std::sort(all.begin(), all.end(), is_nearer);
  const auto is_same = [](const Found& a, const Found& b) { return a.point == b.point; };
  all.erase(std::unique(all.begin(), all.end(), is_same), all.end());
}

std::vector<ScenePoint> points_of(const std::vector<Found>& all) {
  std::vector<ScenePoint> points;
  points.reserve(all.size());
  for (const Found& found : all) points.push_back(found.point);
  return points;
}

std::vector<ScenePoint> nearest_of_all(const SceneStructure& scene, const Vec3f& point, std::size_t count,
                                       float max_distance) {
  if (count == 0 || !has_sense(point, max_distance)) return {};
  double reach = static_cast<double>(max_distance) * max_distance;
  std::vector<Found> nearest;
  visit_near_instances(
      scene, nullptr, 0, point, [&] { return reach; },
      [&](const InstancePoints& instance) {
        instance.append(std::min(reach, instance.reach_of(count, reach)), nearest);
        put_in_order(nearest);
        if (nearest.size() < count) return;
        nearest.resize(count);
        reach = nearest.back().squared_distance;
      });
  return points_of(nearest);
}

std::vector<ScenePoint> all_within(const SceneStructure& scene, const Vec3f& point, float radius) {
  if (!has_sense(point, radius)) return {};
  const double reach = static_cast<double>(radius) * radius;
  std::vector<Found> all;
  visit_near_instances(
      scene, nullptr, 0, point, [&] { return reach; },
      [&](const InstancePoints& instance) { instance.append(reach, all); });
  put_in_order(all);
  return points_of(all);
}

}  // namespace

std::optional<ScenePoint> Scene::closest_point(const Vec3f& point, float max_distance) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    const ScenePoint found = closest(*structure_, point, max_distance);
    return found ? std::optional(found) : std::nullopt;
  });
}

void Scene::closest_point(const PointView& points, std::span<ScenePoint> closest_points, float max_distance,
                          const BatchOptions& options) const {
  require_as_many(points.size(), closest_points.size(), "as many results as points are needed");
  for_each_point(points, options, [&](std::size_t i, const Vec3f& point) {
    closest_points[i] = closest(*structure_, point, max_distance);
  });
}

float Scene::signed_distance(const Vec3f& point) const {
  const auto found = closest_point(point);
  const float distance = found ? found->distance : std::numeric_limits<float>::infinity();
  return contains(point) ? -distance : distance;
}

void Scene::signed_distance(const PointView& points, std::span<float> distances,
                            const BatchOptions& options) const {
  require_as_many(points.size(), distances.size(), "as many results as points are needed");
  for_each_point(points, options,
                 [&](std::size_t i, const Vec3f& point) { distances[i] = signed_distance(point); });
}

std::vector<ScenePoint> Scene::within(const Vec3f& point, float radius) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] { return all_within(*structure_, point, radius); });
}

std::vector<ScenePoint> Scene::nearest(const Vec3f& point, std::size_t count, float max_distance) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] { return nearest_of_all(*structure_, point, count, max_distance); });
}

Lists<ScenePoint> Scene::nearest(const PointView& points, std::size_t count, float max_distance,
                                 const BatchOptions& options) const {
  return list_in_batches<ScenePoint>(
      points.size(), points_per_batch, options, [&](std::size_t i, std::vector<ScenePoint>& found) {
        const std::vector<ScenePoint> here = nearest_of_all(*structure_, points[i], count, max_distance);
        found.insert(found.end(), here.begin(), here.end());
      });
}

Lists<ScenePoint> Scene::within(const PointView& points, float radius, const BatchOptions& options) const {
  return list_in_batches<ScenePoint>(
      points.size(), points_per_batch, options, [&](std::size_t i, std::vector<ScenePoint>& found) {
        const std::vector<ScenePoint> here = all_within(*structure_, points[i], radius);
        found.insert(found.end(), here.begin(), here.end());
      });
}

}  // namespace kerf
