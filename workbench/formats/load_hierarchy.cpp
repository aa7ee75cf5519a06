#include "workbench/formats/load_hierarchy.hpp"

#include <kerf/inspect.hpp>

#include "workbench/base/raise.hpp"
#include "workbench/formats/join_vertices.hpp"

namespace workbench {

using namespace kerf;

Scene load_hierarchy(const std::filesystem::path& file) {
  const Bvh saved = Bvh::load(file);
  if (saved.statistics().references == 0) {
    raise(Error::bad_format, file, "has no triangles");
  }
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
  scene.hierarchy = join_meshes(saved);  // a scene has one mesh
  return scene;
}

}  // namespace workbench
