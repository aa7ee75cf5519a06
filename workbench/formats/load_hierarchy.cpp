#include "workbench/formats/load_hierarchy.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include <kerf/inspect.hpp>
#include <kerf/scene.hpp>

#include "workbench/base/raise.hpp"
#include "workbench/formats/join_vertices.hpp"

namespace workbench {

using namespace kerf;

namespace {

/// More places than these would be gigabytes of them.
constexpr std::size_t max_places = std::size_t{1} << 24;
/// As of glTF files.
constexpr std::size_t max_triangles = std::size_t{1} << 28;

// The vertices and triangles of a hierarchy; its own meshes become one.
PlacedMeshes::Mesh mesh_of(const Bvh& saved) {
  Scene scene;
  scene.triangles.resize(saved.statistics().triangles);
  scene.vertices.resize(3 * scene.triangles.size(), saved.bounds().lower);
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i)
    scene.triangles[i] = {3 * i, 3 * i + 1, 3 * i + 2};
  visit_triangles(layout(saved), [&](std::uint32_t id, const Triangle& triangle) {
    scene.vertices[3 * std::size_t{id}] = triangle.v0;
    scene.vertices[3 * std::size_t{id} + 1] = triangle.v1;
    scene.vertices[3 * std::size_t{id} + 2] = triangle.v2;
  });
  join_vertices(scene);
  return {std::move(scene.vertices), std::move(scene.triangles), join_meshes(saved)};
}

// First `b`, then `a`.
Transform product(const Transform& a, const Transform& b) {
  Transform both;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      both.rows[i][j] = j == 3 ? a.rows[i][3] : 0.0;
      for (int k = 0; k < 3; ++k) both.rows[i][j] += a.rows[i][k] * b.rows[k][j];
    }
  }
  return both;
}

bool is_identity(const Transform& transform) {
  const Transform identity;
  return std::equal(&transform.rows[0][0], &transform.rows[0][0] + 12, &identity.rows[0][0]);
}

class PlaceReader {
 public:
  void add(const kerf::Scene& scene, const Transform& to_outermost) {
    for (const Instance& instance : scene.instances()) {
      const Transform transform = product(to_outermost, instance.transform);
      if (!instance.scene.instances().empty()) {
        add(instance.scene, transform);
      } else if (instance.object.statistics().references != 0) {
        const auto [known, is_new] = numbers_.try_emplace(instance.object.identity(),
                                                          static_cast<std::uint32_t>(placed.meshes.size()));
        if (is_new) placed.meshes.push_back(mesh_of(instance.object));
        placed.places.push_back({known->second, transform});
      }
    }
  }

  PlacedMeshes placed;

 private:
  std::unordered_map<const void*, std::uint32_t> numbers_;
};

}  // namespace

Scene load_hierarchy(const std::filesystem::path& file, Repeats repeats) {
  const kerf::Scene saved = kerf::Scene::load(file);
  if (saved.instance_count() > max_places)
    raise(Error::too_large, file, "has {} instances; this tool takes {}", saved.instance_count(), max_places);
  PlaceReader reader;
  reader.add(saved, {});
  PlacedMeshes& placed = reader.placed;
  if (placed.places.empty()) raise(Error::bad_format, file, "has no triangles");
  Scene scene;
  if (placed.places.size() == 1 && is_identity(placed.places[0].transform)) {
    PlacedMeshes::Mesh& mesh = placed.meshes[0];
    scene.vertices = std::move(mesh.vertices);
    scene.triangles = std::move(mesh.triangles);
    scene.hierarchy = std::move(mesh.hierarchy);
    return scene;
  }
  scene.contents.entries.push_back(
      {"instances", fmt::format("{} of {} hierarchies", placed.places.size(), placed.meshes.size())});
  if (repeats == Repeats::kept) {
    scene.placed = std::move(placed);
    return scene;
  }
  if (placed.triangle_count() > max_triangles)
    raise(Error::too_large, file, "has more than {} triangles when its instances are copied", max_triangles);
  PlacedMeshes::Mesh flat = flattened(placed, max_triangles);
  scene.vertices = std::move(flat.vertices);
  scene.triangles = std::move(flat.triangles);
  return scene;
}

}  // namespace workbench
