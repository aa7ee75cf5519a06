// Writes the inputs from which the fuzzers start: one folder per fuzzer.
//
//     fuzz_seeds DIRECTORY
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <kerf/kerf.hpp>

#include "workbench/generate/solids.hpp"

namespace {

using workbench::Solid;

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

template <class Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string as_obj(const Solid& solid) {
  std::string text = "o solid\n";
  char line[96];
  for (const kerf::Vec3f& v : solid.vertices) {
    std::snprintf(line, sizeof line, "v %g %g %g\n", double{v.x}, double{v.y}, double{v.z});
    text += line;
  }
  for (const auto& [a, b, c] : solid.triangles) {
    std::snprintf(line, sizeof line, "f %u/1/1 %u//2 %u\n", a + 1, b + 1, c + 1);
    text += line;
  }
  return text;
}

std::string as_ply(const Solid& solid) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(solid.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(solid.triangles.size()) + "\nproperty list uchar uint vertex_indices\nend_header\n";
  for (const kerf::Vec3f& v : solid.vertices) append(bytes, v);
  for (const auto& triangle : solid.triangles) {
    bytes += '\3';
    append(bytes, triangle);
  }
  return bytes;
}

std::string as_stl(const Solid& solid) {
  std::string bytes(80, ' ');
  append(bytes, static_cast<std::uint32_t>(solid.triangles.size()));
  for (const auto& triangle : solid.triangles) {
    append(bytes, kerf::Vec3f{});
    for (const std::uint32_t i : triangle) append(bytes, solid.vertices[i]);
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

// One triangle, whose buffer is in the file itself.
const char* const gltf =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"translation":[1,2,3]}],)"
    R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,)"
    R"("count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
    R"("buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
    R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: fuzz_seeds DIRECTORY\n", stderr);
    return 2;
  }
  const std::filesystem::path root = argv[1];
  for (const char* name : {"kerf_file", "mesh", "scene_file"})
    std::filesystem::create_directories(root / name);

  const Solid box = workbench::make_box({-1, -1, -1}, {1, 1, 1}), sphere = workbench::make_sphere(1);
  kerf::Bvh().save(root / "kerf_file" / "empty");
  kerf::build(box.mesh()).save(root / "kerf_file" / "box");
  kerf::build(sphere.mesh()).save(root / "kerf_file" / "sphere");

  // The fuzzer takes numbers from the end of the input and floats from its bits, so that any bytes make a
  // mesh.
  write(root / "mesh" / "zeros", std::string(200, '\0'));
  write(root / "mesh" / "ply", as_ply(sphere));
  write(root / "mesh" / "stl", as_stl(box));

  write(root / "scene_file" / "obj", '\0' + as_obj(box));
  write(root / "scene_file" / "ply", '\1' + as_ply(box));
  write(root / "scene_file" / "stl", '\2' + as_stl(box));
  write(root / "scene_file" / "gltf", std::string(1, '\3') + gltf);
}
