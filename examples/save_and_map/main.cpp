// A hierarchy is built once, saved, and mapped by whoever needs it: no build, and one copy for all processes.
#include <cstdio>
#include <filesystem>

#include <kerf/kerf.hpp>

#include "../common/shapes.hpp"

int main() {
  const std::filesystem::path file = "ring.kerf";
  {
    const shapes::Mesh ring = shapes::make_ring();
    kerf::build({.vertices = ring.vertices, .triangles = ring.triangles}).save(file);
  }  // the mesh is gone; the file has its triangles

  try {
    const kerf::Bvh bvh = kerf::Bvh::map(file);
    std::printf("%zu triangles, inside: %s\n", bvh.statistics().triangles,
                bvh.contains({1, 0, 0}) ? "yes" : "no");
  } catch (const kerf::Error& error) {  // a file of another machine is loaded instead, which converts it
    const kerf::Bvh bvh = kerf::Bvh::load(file);
    std::printf("%zu triangles, loaded: %s\n", bvh.statistics().triangles, error.what());
  }

  // What is damaged is refused, with the reason.
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  try {
    kerf::Bvh::load(file);
  } catch (const kerf::Error& error) {
    std::printf("refused: %s\n", error.what());
  }
  std::filesystem::remove(file);
}
