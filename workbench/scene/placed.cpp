#include "workbench/scene/placed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <kerf/build.hpp>
#include <kerf/layout.hpp>

#include "workbench/base/vectors.hpp"

namespace workbench {

using namespace kerf;

namespace {

Vec3f moved(const Transform& transform, const Vec3f& p) {
  Vec3f to;
  for (int i = 0; i < 3; ++i) {
    const double(&row)[4] = transform.rows[i];
    to[i] = static_cast<float>(row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3]);
  }
  return to;
}

// Around all that stands in `box` before it is moved, and rounding.
Box3f around_moved(const Transform& transform, const Box3f& box) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Box3f around;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f p{(corner & 1) != 0 ? box.upper.x : box.lower.x,
                  (corner & 2) != 0 ? box.upper.y : box.lower.y,
                  (corner & 4) != 0 ? box.upper.z : box.lower.z};
    around = merge(around, moved(transform, p));
  }
  for (int axis = 0; axis < 3; ++axis) {
    around.lower[axis] = std::nextafter(around.lower[axis], -infinity);
    around.upper[axis] = std::nextafter(around.upper[axis], infinity);
  }
  return around;
}

std::vector<Vec3f> corners_of(const Bvh& bvh) {
  std::vector<Vec3f> corners;
  visit_triangles(layout(bvh), [&](std::uint32_t, const Triangle& triangle) {
    corners.insert(corners.end(), {triangle.v0, triangle.v1, triangle.v2});
  });
  return corners;
}

}  // namespace

std::size_t PlacedMeshes::triangle_count() const {
  std::size_t count = 0;
  for (const Place& place : places) count += meshes[place.mesh].triangles.size();
  return count;
}

std::size_t PlacedMeshes::stored_triangles() const {
  std::size_t count = 0;
  for (const Mesh& mesh : meshes) count += mesh.triangles.size();
  return count;
}

Triangle PlacedMeshes::triangle(std::size_t place, std::uint32_t number) const {
  const Mesh& mesh = meshes[places[place].mesh];
  const auto& [a, b, c] = mesh.triangles[number];
  const Transform& transform = places[place].transform;
  return {moved(transform, mesh.vertices[a]), moved(transform, mesh.vertices[b]),
          moved(transform, mesh.vertices[c])};
}

std::vector<Bvh> build_objects(const PlacedMeshes& placed, const BuildOptions& options) {
  std::vector<Bvh> objects;
  objects.reserve(placed.meshes.size());
  for (const PlacedMeshes::Mesh& mesh : placed.meshes)
    objects.push_back(mesh.hierarchy ? *mesh.hierarchy : build(mesh.mesh(), options));
  return objects;
}

kerf::Scene build_scene(const PlacedMeshes& placed, const std::vector<Bvh>& objects,
                        const BuildOptions& options) {
  std::vector<Instance> instances;
  instances.reserve(placed.places.size());
  for (const auto& [mesh, transform] : placed.places)
    instances.push_back({.object = objects[mesh], .transform = transform});
  return build(std::span<const Instance>(instances), options);
}

Box3f bounds_of(const PlacedMeshes& placed, const std::vector<Bvh>& objects) {
  std::vector<std::vector<Vec3f>> corners(objects.size());  // of the meshes that were looked at
  Box3f bounds;
  for (const auto& [mesh, transform] : placed.places) {
    const Bvh& object = objects[mesh];
    // Most places of many lie within the bounds of others.
    if (object.bounds().empty()) continue;
    const Box3f around = around_moved(transform, object.bounds());
    if (merge(merge(bounds, around.lower), around.upper) == bounds) continue;
    if (corners[mesh].empty()) corners[mesh] = corners_of(object);
    for (const Vec3f& corner : corners[mesh]) bounds = merge(bounds, moved(transform, corner));
  }
  return bounds;
}

PlacedMeshes::Mesh flattened(const PlacedMeshes& placed, std::size_t max_triangles) {
  const std::size_t count = placed.triangle_count(),
                    step = 1 + (count - std::min<std::size_t>(count, 1)) / max_triangles;
  PlacedMeshes::Mesh flat;
  flat.triangles.reserve(count / step + 1);
  std::size_t next = 0;  // the triangle that is taken next, counted from the first of the place at hand
  std::unordered_map<std::uint32_t, std::uint32_t> numbers;  // of the vertices of a place
  for (const auto& [number, transform] : placed.places) {
    const PlacedMeshes::Mesh& mesh = placed.meshes[number];
    numbers.clear();
    for (; next < mesh.triangles.size(); next += step) {
      auto& triangle = flat.triangles.emplace_back(mesh.triangles[next]);
      for (std::uint32_t& vertex : triangle) {
        const auto [known, is_new] =
            numbers.try_emplace(vertex, static_cast<std::uint32_t>(flat.vertices.size()));
        if (is_new) flat.vertices.push_back(moved(transform, mesh.vertices[vertex]));
        vertex = known->second;
      }
    }
    next -= mesh.triangles.size();
  }
  return flat;
}

kerf::Bvh build_stand_in(const PlacedMeshes& placed) {
  constexpr std::size_t max_triangles = 1'000'000;
  return kerf::build(flattened(placed, max_triangles).mesh(), {.builder = kerf::Builder::bvh});
}

}  // namespace workbench
