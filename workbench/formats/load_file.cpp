#include "workbench/formats/load_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <utility>

#include <kerf/error.hpp>

#include "workbench/base/raise.hpp"
#include "workbench/formats/check_mesh.hpp"
#include "workbench/formats/file_bytes.hpp"
#include "workbench/formats/load_hierarchy.hpp"
#include "workbench/formats/read_gltf.hpp"
#include "workbench/formats/read_obj.hpp"
#include "workbench/formats/read_ply.hpp"
#include "workbench/formats/read_stl.hpp"

namespace workbench {
namespace {

using kerf::Error;

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
          "of unknown type; known are .obj .ply .stl .gltf .glb, each also with .gz appended, and .kerf; "
          "--format names it whatever the file is called");
  }
  return extension;
}

ReadMesh read(const std::filesystem::path& file, std::string_view format, const FileBytes& bytes) {
  if (format == ".ply") return read_ply(file, bytes);
  if (format == ".stl") return read_stl(file, bytes);
  if (format == ".obj") return read_obj(file, bytes);
  return read_gltf(file, bytes);
}

// Meshes of a glTF file at their places.
Scene placed_scene(const std::filesystem::path& file, GltfMeshes read) {
  Scene scene;
  scene.contents = std::move(read.contents);
  scene.placed.emplace();
  for (ReadMesh& mesh : read.meshes) {
    check_mesh(file, mesh);
    scene.contents.flattened_triangles += mesh.contents.flattened_triangles;
    scene.placed->meshes.push_back({std::move(mesh.vertices), std::move(mesh.triangles)});
  }
  scene.placed->places = std::move(read.places);
  return scene;
}

}  // namespace

Scene load_file(const std::filesystem::path& file, std::string_view given, Repeats repeats) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) raise(Error::io, file, "no such file");
  const std::string format = given.empty() ? format_of(file) : std::string(".").append(given);
  if (format == ".kerf") return load_hierarchy(file, repeats);
  const FileBytes bytes(file);
  const bool is_wide_text = bytes.view().starts_with("\xff\xfe") || bytes.view().starts_with("\xfe\xff");
  if (is_wide_text && format != ".stl")  // whose binary header may be any bytes
    raise(Error::bad_format, file, "is a text in UTF-16; only ASCII and UTF-8 are read");
  ReadMesh mesh;
  if (repeats == Repeats::kept && (format == ".gltf" || format == ".glb")) {
    GltfMeshes meshes = read_gltf_meshes(file, bytes);
    if (!meshes.places.empty()) return placed_scene(file, std::move(meshes));
    mesh = std::move(meshes.meshes.front());
    mesh.contents = std::move(meshes.contents);
  } else {
    mesh = read(file, format, bytes);
  }
  check_mesh(file, mesh);
  Scene scene;
  scene.vertices = std::move(mesh.vertices);
  scene.triangles = std::move(mesh.triangles);
  scene.contents = std::move(mesh.contents);
  return scene;
}

}  // namespace workbench
