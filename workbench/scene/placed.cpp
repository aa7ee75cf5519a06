#include "workbench/scene/placed.hpp"

#include <algorithm>
#include <unordered_map>

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

}  // namespace workbench
