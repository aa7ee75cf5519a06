// .gltf and .glb files.
#include "fuzz/scene_file.hpp"
#include "workbench/formats/read_gltf.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint64_t max_triangles = 100'000;  // a few bytes may ask for all instances that there can be
  scene_file::check(data, size, [](const std::filesystem::path& file, const workbench::FileBytes& bytes) {
    return workbench::read_gltf(file, bytes, max_triangles);
  });
  return 0;
}
