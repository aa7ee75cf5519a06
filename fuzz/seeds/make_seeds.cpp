// Writes the inputs from which the fuzzers start: one folder per fuzzer.
//
//     fuzz_seeds DIRECTORY
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

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

// Texts that use what their format can do.

constexpr std::string_view obj_texts[] = {
    "\xef\xbb\xbf# c \\\nmtllib a.mtl\nv 0 0 0 1 0 0\nv 1. -.5e-3 +2E2\r\nv 0 \\\n 1 0\nvn 0 0 1\nvt 0 0\nf "
    "1/1/1 2//1 \\\n3/1\nf -1 -2 "
    "-3\nl 1 2\n",
    "v nan 0 -1.#IND\rv 0 0 0\rv 4 0 0\rv 4 4 0\rv 2 1 0\rv 0 4 0\rf 2 3 4 5 6\rf 1 2\rcurv 0 1 1 2\r",
    "v 6000000.1 0 0\nv 6000000.2 0 0\nv 6000000.2 1 0\nf 1 2 3\n"};

constexpr std::string_view ply_texts[] = {
    "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty double y\nproperty uchar "
    "red\nproperty short z\n"
    "element face 2\nproperty list uchar int vertex_indices\nproperty list int float more\nelement edge "
    "0\nend_header\n0 0 1 0\n1 0 2 "
    "0\n\n1 1\n3 0 0 1 4 0\n4 0 1 2 3 1 nan\n3 0 1 2 0\n",
    "ply\r\nformat ascii 1.0\r\nelement tristrips 1\r\nproperty list int int vertex_indices\r\nelement "
    "vertex 4\r\nproperty float "
    "x\r\nproperty float y\r\nproperty float z\r\nend_header\r\n6 0 1 2 3 -1 0 0 0 0 1 0 0 0 1 0 1 1 0"};

constexpr std::string_view stl_texts[] = {
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
    "0\nendloop\nendfacet\nendsolid a\n",
    " SOLID\rFACET NORMAL nan\rOUTER LOOP\rVERTEX 0 0 0\rVERTEX 1 0 0\rVERTEX 1 1 0\rVERTEX 0 1 0\rEND "
    "LOOP\rEND "
    "FACET\rENDSOLIDb\rsolid\rendsolid"};

// One triangle, whose buffer is in the file itself; nodes and whatever else stand behind it.
std::string gltf(std::string_view primitive, std::string_view rest) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"buffers":[{"byteLength":48,"uri":)"
         R"("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAD/AAAA"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12}],"accessors":[)"
         R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
         R"({"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"},)"
         R"({"bufferView":1,"componentType":5121,"count":3,"type":"VEC4","normalized":true},)"
         R"({"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,)"
         R"("componentType":5121},"values":{"bufferView":0,"byteOffset":12}}}],"meshes":[{"weights":[0.5],"primitives":[{)" +
         std::string(primitive) + "}]}]," + std::string(rest) + "}";
}

const std::string gltf_texts[] = {
    gltf(R"("attributes":{"POSITION":0})", R"("nodes":[{"mesh":0,"translation":[1,2,3]}])"),
    gltf(
        R"("mode":5,"indices":1,"attributes":{"POSITION":0,"NORMAL":9},"targets":[{"POSITION":3}])",
        R"("nodes":[{"children":[1],"scale":[-1,2,1]},{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,1,2,3,1]}])"),
    gltf(R"("attributes":{"POSITION":0,"JOINTS_0":2,"WEIGHTS_0":2})",
         R"("nodes":[{"mesh":0,"skin":0,"children":[1]},{"rotation":[0,0,1,1]}],"skins":[{"joints":[1,0]}])"),
    gltf(
        R"("mode":6,"attributes":{"POSITION":3})",
        R"("extensionsRequired":["EXT_mesh_gpu_instancing"],"nodes":[{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":)"
        R"({"attributes":{"TRANSLATION":0,"SCALE":0,"ROTATION":2}}}}])"),
    gltf(
        R"("attributes":{"POSITION":0},"extensions":{"KHR_draco_mesh_compression":{"bufferView":1,"attributes":{"POSITION":0}}})",
        R"("nodes":[{"mesh":0}])")};

// As a .glb file, without a binary chunk.
std::string as_glb(std::string text) {
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  for (const std::size_t number : {std::size_t{2}, 20 + text.size(), text.size()})
    append(bytes, static_cast<std::uint32_t>(number));
  return bytes + "JSON" + text;
}

template <class Texts>
void write_all(const std::filesystem::path& folder, const Texts& texts) {
  int number = 0;
  for (const auto& text : texts) write(folder / ("text" + std::to_string(number++)), std::string(text));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: fuzz_seeds DIRECTORY\n", stderr);
    return 2;
  }
  const std::filesystem::path root = argv[1];
  for (const char* name : {"c_interface", "gltf_file", "kerf_file", "kerf_scene_file", "mesh", "obj_file",
                           "ply_file", "stl_file"})
    std::filesystem::create_directories(root / name);

  const Solid box = workbench::make_box({-1, -1, -1}, {1, 1, 1}), sphere = workbench::make_sphere(1);
  kerf::Bvh().save(root / "kerf_file" / "empty");
  kerf::build(box.mesh()).save(root / "kerf_file" / "box");
  kerf::build(sphere.mesh()).save(root / "kerf_file" / "sphere");

  const std::array instances{kerf::Instance{.object = kerf::build(box.mesh())},
                             kerf::Instance{.object = kerf::build(sphere.mesh()),
                                            .transform = {{{0, -1, 0, 3}, {1, 0.5, 0, 0}, {0, 0, 2, 0}}},
                                            .number = 7}};
  const kerf::Scene pair = kerf::build(instances);
  const std::array pairs{kerf::Instance{.scene = pair}, instances[1]};
  pair.save(root / "kerf_scene_file" / "pair");
  kerf::build(pairs).save(root / "kerf_scene_file" / "scenes");
  kerf::build(box.mesh()).save(root / "kerf_scene_file" / "box");

  // The fuzzer takes numbers from the end of the input and floats from its bits, so that any bytes make a
  // mesh.
  write(root / "mesh" / "zeros", std::string(200, '\0'));
  write(root / "mesh" / "ply", as_ply(sphere));
  write(root / "mesh" / "stl", as_stl(box));

  write(root / "c_interface" / "zeros", std::string(400, '\0'));
  write(root / "c_interface" / "ply", as_ply(sphere));

  write(root / "obj_file" / "box", as_obj(box));
  write_all(root / "obj_file", obj_texts);
  write(root / "ply_file" / "box", as_ply(box));
  write_all(root / "ply_file", ply_texts);
  write(root / "stl_file" / "box", as_stl(box));
  write_all(root / "stl_file", stl_texts);
  write_all(root / "gltf_file", gltf_texts);
  write(root / "gltf_file" / "glb", as_glb(gltf_texts[0]));
}
