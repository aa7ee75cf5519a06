// Scene files. The first byte of the input selects the format that the rest claims to have.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <kerf/kerf.hpp>
#include <unistd.h>

#include "workbench/open/load_scene.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static constexpr const char* extensions[] = {".obj",    ".ply",    ".stl",    ".gltf",    ".glb",
                                               ".obj.gz", ".ply.gz", ".stl.gz", ".gltf.gz", ".glb.gz"};
  if (size == 0) return 0;
  const std::string name =
      "kerf-fuzz-" + std::to_string(::getpid()) + extensions[data[0] % std::size(extensions)];
  const std::filesystem::path path = std::filesystem::temp_directory_path() / name;
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  try {
    const workbench::Scene scene = workbench::load_scene(path.string());
    if (scene.triangles.size() < 10'000) (void)kerf::build(scene.mesh());
  } catch (const kerf::Error&) {
  }
  std::filesystem::remove(path);
  return 0;
}
