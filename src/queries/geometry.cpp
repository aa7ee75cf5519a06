// What is at a hit, without the caller's meshes; and what the hierarchy has of each of them.
#include <cmath>

#include <kerf/bvh.hpp>
#include <kerf/layout.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "base/raise.hpp"
#include "math/box3f.hpp"
#include "math/predicates.hpp"
#include "math/ray_crossing.hpp"
#include "math/triangle.hpp"
#include "structure.hpp"

namespace kerf {
namespace {

std::optional<Triangle> find_triangle(const Structure& structure, const PrimitiveId& id) {
  const auto& first = structure.first_triangles;
  if (id.mesh >= first.size() || id.mesh + 1 >= first.size()) return std::nullopt;
  if (id.primitive >= first[id.mesh + 1] - first[id.mesh]) return std::nullopt;
  const std::uint32_t number = first[id.mesh] + id.primitive;
  const ChildLink leaf = structure.triangle_leaves(structure.wide, first.back(), number);
  if (!leaf.is_leaf()) return std::nullopt;
  std::uint32_t i = 0;
  while (triangle_id(structure.wide, leaf, i) != number) ++i;
  return triangle_in(structure.wide, leaf, i);
}

// The sign of the cross product of two edges along each axis is exact, and its size good enough for floats:
// where it cancels in double precision, it is summed without rounding.
Vec3d normal_of(const Triangle& triangle) {
  const auto component = [&](int j, int k) {
    const auto& [a, b, c] = triangle;
    const double left = (static_cast<double>(b[j]) - a[j]) * (static_cast<double>(c[k]) - a[k]);
    const double right = (static_cast<double>(b[k]) - a[k]) * (static_cast<double>(c[j]) - a[j]);
    if (std::abs(left - right) > 0x1p-24 * (std::abs(left) + std::abs(right))) return left - right;
    ExactSum sum;
    sum.add_product(b[j], c[k]);
    sum.add_product(-b[j], a[k]);
    sum.add_product(-a[j], c[k]);
    sum.add_product(-b[k], c[j]);
    sum.add_product(b[k], a[j]);
    sum.add_product(a[k], c[j]);
    return sum.value();
  };
  return {component(1, 2), component(2, 0), component(0, 1)};
}

// The sign of d . n, without rounding where double precision leaves it open.
bool comes_from_front(const Ray& ray, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const Determinant estimate = determinant(widen(ray.direction), difference(b, a), difference(c, a));
  if (estimate.certain()) return estimate.value < 0.0;
  return exact_edge_side_sum(a, ray.direction, b, c).sign() <= 0;
}

}  // namespace

std::optional<Triangle> Bvh::triangle(const PrimitiveId& id) const {
  return report_out_of_memory([&] { return find_triangle(*structure_, id); });
}

HitGeometry Bvh::geometry(const Ray& ray, const Hit& hit) const {
  const PlainFloatingPoint plain;
  const std::optional<Triangle> found = triangle({hit.primitive, hit.mesh});
  if (!found) raise(Error::invalid_argument, "a hit of no triangle of this hierarchy has no geometry");
  const Vec3d normal = normal_of(*found);
  // Scaled first: the square of the length of a tiny or a huge one leaves the range of a double.
  const double largest = largest_component(normal);
  const Vec3d scaled{normal.x / largest, normal.y / largest, normal.z / largest};
  const double length = std::sqrt(dot(scaled, scaled));
  return {.triangle = *found,
          .normal = {static_cast<float>(scaled.x / length), static_cast<float>(scaled.y / length),
                     static_cast<float>(scaled.z / length)},
          .front = comes_from_front(ray, *found)};
}

std::vector<MeshStatistics> Bvh::mesh_statistics() const {
  return report_out_of_memory([&] {
    const Structure& structure = *structure_;
    const auto& first = structure.first_triangles;
    std::vector<MeshStatistics> meshes(first.empty() ? 0 : first.size() - 1);
    std::vector<bool> stored(first.empty() ? 0 : first.back());
    visit_triangles(layout(*this), [&](std::uint32_t id, const Triangle& triangle) {
      MeshStatistics& mesh = meshes[locate(structure, id).mesh];
      ++mesh.references;
      mesh.bounds = merge(mesh.bounds, bounds_of(triangle));
      stored[id] = true;
    });
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      meshes[i].triangles = first[i + 1] - first[i];
      for (std::uint32_t id = first[i]; id < first[i + 1]; ++id) meshes[i].left_out += !stored[id];
    }
    return meshes;
  });
}

}  // namespace kerf
