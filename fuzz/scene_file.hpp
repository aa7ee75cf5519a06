// Any bytes as a scene file of one format.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include <kerf/kerf.hpp>
#include <sys/mman.h>
#include <unistd.h>

#include "workbench/base/vectors.hpp"
#include "workbench/formats/check_mesh.hpp"
#include "workbench/formats/file_bytes.hpp"
#include "workbench/formats/read_mesh.hpp"

namespace scene_file {

/// Reads `bytes` by `read`, a function of a path and a `FileBytes`. Either there is an error of one line that
/// names the file, or a mesh of which a hierarchy can be built.
template <class Read>
void check(const std::uint8_t* bytes, std::size_t size, const Read& read) {
  static const int descriptor = ::memfd_create("scene", 0);
  static const std::filesystem::path path = "/proc/self/fd/" + std::to_string(descriptor);
  if (::ftruncate(descriptor, 0) != 0 || ::pwrite(descriptor, bytes, size, 0) != static_cast<ssize_t>(size))
    std::abort();
  workbench::ReadMesh mesh;
  try {
    const workbench::FileBytes file(path);
    mesh = read(path, file);
    workbench::check_mesh(path, mesh);
  } catch (const kerf::Error& error) {
    const std::string sentence = error.what();
    if (!sentence.starts_with(path.string()) || sentence.find_first_of("\n\r") != std::string::npos)
      std::abort();
    return;
  }
  if (mesh.triangles.empty()) std::abort();
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      if (vertex >= mesh.vertices.size() || !workbench::is_finite(mesh.vertices[vertex])) std::abort();
    }
  }
  if (mesh.triangles.size() > 1000) return;
  try {
    (void)kerf::build({.vertices = mesh.vertices, .triangles = mesh.triangles}, {.threads = 1});
  } catch (const kerf::Error&) {  // of coordinates that are too large
  }
}

}  // namespace scene_file
