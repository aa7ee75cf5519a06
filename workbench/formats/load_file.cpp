#include "workbench/formats/load_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include <kerf/error.hpp>

#include "workbench/base/raise.hpp"
#include "workbench/base/vectors.hpp"
#include "workbench/formats/checks.hpp"
#include "workbench/formats/import.hpp"
#include "workbench/formats/join_vertices.hpp"
#include "workbench/formats/load_hierarchy.hpp"
#include "workbench/formats/read_bytes.hpp"
#include "workbench/formats/read_ply.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Vec3f;

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// The extension that names the format; for a gzipped file, the one before .gz.
std::string format_of(const std::filesystem::path& file) {
  constexpr std::array known{".obj", ".ply", ".stl", ".gltf", ".glb", ".kerf"};
  std::filesystem::path unpacked = file;
  const bool packed = lower_case(unpacked.extension().string()) == ".gz";
  if (packed) unpacked.replace_extension();
  const std::string extension = lower_case(unpacked.extension().string());
  if (std::find(known.begin(), known.end(), extension) == known.end() || (packed && extension == ".kerf")) {
    raise(Error::bad_format, file,
          "of unknown type; known are .obj .ply .stl .gltf .glb, each also with .gz appended, and .kerf");
  }
  return extension;
}

void check_vertices(const Scene& scene, const std::filesystem::path& file) {
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (const std::uint32_t vertex : scene.triangles[i]) {
      if (vertex >= scene.vertices.size()) {
        raise(Error::index_out_of_range, file, "triangle {} names vertex {}, but there are {}", i, vertex,
              scene.vertices.size());
      }
      const Vec3f& p = scene.vertices[vertex];
      if (!is_finite(p)) {
        raise(Error::non_finite_vertex, file, "vertex {} of triangle {} is not finite: ({}, {}, {})", vertex,
              i, p.x, p.y, p.z);
      }
    }
  }
}

Scene read_scene(const std::filesystem::path& file, std::string_view format, const std::string& bytes) {
  if (format == ".ply") return read_ply(file, bytes);
  if (format == ".obj") return import(file, format, plain_obj(file, bytes));
  if (format == ".stl") return import(file, format, plain_stl(file, bytes));
  format == ".glb" ? check_glb(file, bytes) : check_gltf(file, bytes, {});
  return import(file, format, bytes);
}

}  // namespace

Scene load_file(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    raise(Error::io, file, "no such file");
  }
  const std::string format = format_of(file);
  if (format == ".kerf") return load_hierarchy(file);
  Scene scene = read_scene(file, format, read_bytes(file));
  if (scene.triangles.empty()) raise(Error::bad_format, file, "has no triangles");
  check_vertices(scene, file);
  join_vertices(scene);
  return scene;
}

}  // namespace workbench
