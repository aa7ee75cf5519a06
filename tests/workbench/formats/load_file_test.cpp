#include "workbench/formats/load_file.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <gtest/gtest.h>
#include <kerf/error.hpp>
#include <zlib.h>

#include "support/temporary_directory.hpp"
#include "workbench/base/vectors.hpp"

namespace workbench {
namespace {

using kerf::Error;

template <class... Values>
std::string binary(Values... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
  return bytes;
}

std::string gzip(std::string_view bytes) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, static_cast<uLong>(bytes.size())) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

// One triangle, (0 0 0) (1 0 0) (0 1 0), in every format.

const std::string obj_vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string obj = obj_vertices + "f 1 2 3\n";

std::string ply_header(std::string_view format, std::string_view vertices = "3",
                       std::string_view faces = "1") {
  return "ply\nformat " + std::string(format) + " 1.0\ncomment a test\nelement vertex " +
         std::string(vertices) + "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::string(faces) + "\nproperty list uchar int vertex_indices\nend_header\n";
}
const std::string ascii_ply = ply_header("ascii") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const std::string vertex_bytes = binary(0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f);
const std::string binary_ply = ply_header("binary_little_endian") + vertex_bytes + '\3' + binary(0, 1, 2);

std::string binary_stl(std::uint32_t promised, const std::string& vertices = vertex_bytes) {
  return std::string(80, 'x') + binary(promised) + binary(0.0f, 0.0f, 1.0f) + vertices +
         binary(std::uint16_t{0});
}
const std::string ascii_stl =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    "endsolid a\n";

std::string gltf_buffer(std::uint16_t last_index = 2) {
  return vertex_bytes + binary(std::uint16_t{0}, std::uint16_t{1}, last_index, std::uint16_t{0});
}
// The buffer's "uri" and its comma, if any, and the node.
std::string gltf(std::string_view uri, std::string_view node = R"("mesh":0)") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{)" + std::string(node) +
         R"(}],"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],)"
         R"("textures":[{"source":0}],"images":[{"uri":"absent.png"}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],"buffers":[{)" +
         std::string(uri) +
         R"("byteLength":44}],"bufferViews":[{"buffer":0,"byteLength":36},)"
         R"({"buffer":0,"byteOffset":36,"byteLength":6}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,)"
         R"("type":"VEC3","max":[1,1,0],"min":[0,0,0]},{"bufferView":1,"componentType":5123,"count":3,)"
         R"("type":"SCALAR"}]})";
}
std::string glb(const std::string& buffer) {
  std::string json = gltf("");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto json_bytes = static_cast<std::uint32_t>(json.size()),
             bytes = static_cast<std::uint32_t>(buffer.size());
  return "glTF" + binary(std::uint32_t{2}, 28 + json_bytes + bytes, json_bytes) + "JSON" + json +
         binary(bytes) + std::string("BIN\0", 4) + buffer;
}

void expect_the_triangle(const std::string& file) {
  SCOPED_TRACE(file);
  const Scene scene = load_file(file);
  ASSERT_EQ(scene.triangles.size(), 1u);
  const auto [a, b, c] = scene.triangles[0];
  EXPECT_EQ(scene.vertices.at(a), (Vec3f{0, 0, 0}));
  EXPECT_EQ(scene.vertices.at(b), (Vec3f{1, 0, 0}));
  EXPECT_EQ(scene.vertices.at(c), (Vec3f{0, 1, 0}));
}

TEST(LoadFile, ReadsEveryFormat) {
  const TemporaryDirectory directory;
  directory.write("buffer.bin", gltf_buffer());
  expect_the_triangle(directory.write("a.obj", obj));
  expect_the_triangle(directory.write("ascii.ply", ascii_ply));
  expect_the_triangle(directory.write("binary.ply", binary_ply));
  expect_the_triangle(directory.write("ascii.stl", ascii_stl));
  expect_the_triangle(directory.write("binary.stl", binary_stl(1)));
  expect_the_triangle(directory.write("a.gltf", gltf(R"("uri":"buffer.bin",)")));
  expect_the_triangle(directory.write("a.glb", glb(gltf_buffer())));
  expect_the_triangle(directory.write("A.OBJ", obj));
}

TEST(LoadFile, ReadsEveryFormatGzipped) {
  const TemporaryDirectory directory;
  directory.write("buffer.bin", gltf_buffer());
  expect_the_triangle(directory.write("a.obj.gz", gzip(obj)));
  expect_the_triangle(directory.write("a.ply.gz", gzip(binary_ply)));
  expect_the_triangle(directory.write("a.stl.gz", gzip(binary_stl(1))));
  expect_the_triangle(directory.write("a.gltf.gz", gzip(gltf(R"("uri":"buffer.bin",)"))));
  expect_the_triangle(directory.write("a.glb.gz", gzip(glb(gltf_buffer()))));
}

TEST(LoadFile, AppliesTransformsOfNodesMirroredOnesToo) {
  const TemporaryDirectory directory;
  directory.write("buffer.bin", gltf_buffer());
  const Scene scene = load_file(directory.write(
      "a.gltf", gltf(R"("uri":"buffer.bin",)", R"("mesh":0,"scale":[-2,1,1],"translation":[0,0,5])")));
  ASSERT_EQ(scene.triangles.size(), 1u);
  EXPECT_EQ(scene.vertices.at(scene.triangles[0][0]), (Vec3f{0, 0, 5}));
  EXPECT_EQ(scene.vertices.at(scene.triangles[0][1]), (Vec3f{-2, 0, 5}));
  EXPECT_EQ(scene.vertices.at(scene.triangles[0][2]), (Vec3f{0, 1, 5}));
}

float area_of(const Scene& scene) {
  float area = 0.0f;
  for (const auto& [a, b, c] : scene.triangles) {
    const Vec3f ab = scene.vertices[b] - scene.vertices[a], ac = scene.vertices[c] - scene.vertices[a];
    area += 0.5f * length(cross(ab, ac));
  }
  return area;
}

TEST(LoadFile, TriangulatesPolygonsWithoutLosingArea) {
  const TemporaryDirectory directory;
  // An L of area 3, which a fan from its first vertex would not cover.
  const Scene of_obj = load_file(directory.write(
      "a.obj", "v 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nf 1 2 3 4 5 6\nl 1 2\np 1\nf 1 2\n"));
  EXPECT_EQ(of_obj.triangles.size(), 4u);
  EXPECT_FLOAT_EQ(area_of(of_obj), 3.0f);
  // The same, a face of two vertices, and one of none.
  const Scene of_ply = load_file(directory.write(
      "a.ply",
      ply_header("ascii", "6", "3") + "2 1 0\n1 1 0\n1 2 0\n0 2 0\n0 0 0\n2 0 0\n6 0 1 2 3 4 5\n2 0 1\n0\n"));
  EXPECT_EQ(of_ply.triangles, of_obj.triangles);
  const Scene of_stl = load_file(directory.write(
      "a.stl",
      "solid\nfacet\nouter loop\nvertex 2 1 0\nvertex 1 1 0\nvertex 1 2 0\nvertex 0 2 0\nvertex 0 0 0\n"
      "vertex 2 0 0\nendloop\nendfacet\nendsolid\n"));
  EXPECT_EQ(of_stl.triangles, of_obj.triangles);
}

TEST(LoadFile, ReadsPlyOfAnyByteOrderWithPropertiesNobodyAskedFor) {
  const TemporaryDirectory directory;
  const auto big = [](auto value) {
    std::string bytes = binary(value);
    std::reverse(bytes.begin(), bytes.end());
    return bytes;
  };
  std::string bytes =
      "ply\r\nformat binary_big_endian 1.0\r\nelement camera 1\r\nproperty list uchar short views\r\n"
      "element vertex 3\r\nproperty double z\r\nproperty uchar red\r\nproperty float x\r\nproperty short "
      "y\r\n"
      "element face 1\r\nproperty float quality\r\nproperty list ushort uint vertex_index\r\nend_header\r\n";
  bytes += big(std::uint8_t{2}) + big(std::int16_t{7}) + big(std::int16_t{8});
  for (const auto& [x, y] : {std::pair<float, std::int16_t>{0.0f, 0}, {1.0f, 0}, {0.0f, 1}}) {
    bytes += big(0.0) + big(std::uint8_t{255}) + big(x) + big(y);
  }
  bytes += big(0.5f) + big(std::uint16_t{3}) + big(0u) + big(1u) + big(2u);
  expect_the_triangle(directory.write("a.ply", bytes));
}

TEST(LoadFile, UnderstandsTheOddSyntaxOfObj) {
  const TemporaryDirectory directory;
  expect_the_triangle(directory.write("negative.obj", obj_vertices + "f -3 -2 -1\n"));
  expect_the_triangle(
      directory.write("normals.obj", "mtllib absent.mtl\n" + obj_vertices + "vn 0 0 1\nf 1//1 2//1 3//1"));
  expect_the_triangle(directory.write("joined.obj", obj_vertices + "f 1 \\\r\n 2 3 # and no more\r\n"));
  expect_the_triangle(directory.write("before.obj", "f 1 2 3\n" + obj_vertices));
  expect_the_triangle(
      directory.write("colours.obj", "v 0 0 0 1 .5 0\nv 1. -0 0 1 .5 0\nv .0 +1e0 0 1 .5 0\nf 1 2 3\n"));
}

TEST(LoadFile, JoinsVerticesAtTheSamePlace) {
  const TemporaryDirectory directory;
  const Scene scene = load_file(directory.write("a.stl", binary_stl(2) + binary_stl(1).substr(84)));
  EXPECT_EQ(scene.triangles.size(), 2u);
  EXPECT_EQ(scene.vertices.size(), 3u);
}

TEST(LoadFile, KeepsDegenerateTriangles) {
  const TemporaryDirectory directory;
  EXPECT_EQ(load_file(directory.write("a.obj", obj + "f 1 1 2\nf 3 3 3\n")).triangles.size(), 3u);
  EXPECT_EQ(load_file(directory.write(
                          "a.ply", ply_header("ascii", "3", "2") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 1 1 1\n"))
                .triangles.size(),
            2u);
}

struct BadFile {
  std::string name, bytes;
  Error::Code code;
  std::string cause;  ///< part of the sentence
};

TEST(LoadFile, SaysInOneLineWhatIsWrongAndWhere) {
  const TemporaryDirectory directory;
  directory.write("buffer.bin", gltf_buffer());
  directory.write("short.bin", gltf_buffer().substr(0, 20));
  directory.write("bad_index.bin", gltf_buffer(7));
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const std::string nan_vertices = binary(0.0f, 0.0f, 0.0f, 1.0f, nan, 0.0f, 0.0f, 1.0f, 0.0f);
  const std::string little = ply_header("binary_little_endian");
  const BadFile files[] = {
      {"empty.obj", "", Error::bad_format, "is empty"},
      {"wide.obj", std::string("\xff\xfev\0 \0", 6), Error::bad_format, "is a text in UTF-16"},
      {"a.xyz", "1 2 3", Error::bad_format, "unknown type"},
      {"none.obj", obj_vertices, Error::bad_format, "no triangles"},
      {"index.obj", obj + "f 1 2 x", Error::bad_format, "line 5: 'x' is not the number of a vertex"},
      {"range.obj", obj + "f 1 2 4\n", Error::index_out_of_range, "line 5: the face names vertex 4"},
      {"zero.obj", obj_vertices + "f 0 1 2\n", Error::index_out_of_range, "line 4: the face names vertex 0"},
      {"negative.obj", obj_vertices + "f -1 -2 -4\n", Error::index_out_of_range,
       "line 4: the face names vertex -4"},
      {"nan.obj", "v 0 0 0\nv 0 nan 0\nv 0 1 0\nf 1 2 3\n", Error::non_finite_vertex,
       "line 2: vertex 2 is not finite"},
      {"inf.obj", "v 0 0 0\nv 0 1 0\nv 0 1 1e39\nf 1 2 3\n", Error::non_finite_vertex,
       "line 3: vertex 3 is not finite"},
      {"word.obj", "v 0 0 zero\n" + obj, Error::bad_format, "line 1: vertex 1: 'zero' is not a number"},
      {"short.obj", "v 0 0\n" + obj, Error::bad_format, "line 1: vertex 1 has 2 coordinates"},

      {"none.ply", "hello", Error::bad_format, "line 1"},
      {"header.ply", ascii_ply.substr(0, 60), Error::bad_format, "truncated: the header has no end_header"},
      {"cut.ply", ascii_ply.substr(0, ascii_ply.size() - 3), Error::bad_format, "truncated: line 14: face 0"},
      {"cut_vertices.ply", ascii_ply.substr(0, ascii_ply.size() - 16), Error::bad_format,
       "truncated: line 11: 3 elements vertex cannot be in the 11 bytes"},
      {"range.ply", ply_header("ascii") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", Error::index_out_of_range,
       "face 0 names vertex 3"},
      {"negative.ply", ply_header("ascii") + "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", Error::index_out_of_range,
       "face 0 names vertex -1"},
      {"nan.ply", ply_header("ascii") + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", Error::non_finite_vertex,
       "vertex 1"},
      {"word.ply", ply_header("ascii") + "0 0 0\n1 b 0\n0 1 0\n3 0 1 2\n", Error::bad_format,
       "line 12: vertex 1: 'b'"},
      {"long_list.ply", ply_header("ascii") + "0 0 0\n1 0 0\n0 1 0\n2000000000 0 1 2\n", Error::bad_format,
       "truncated: line 14"},
      {"cut_binary.ply", binary_ply.substr(0, binary_ply.size() - 1), Error::bad_format,
       "truncated: ends at byte"},
      {"cut_binary_vertices.ply", little + vertex_bytes.substr(1), Error::bad_format,
       "3 elements vertex cannot be in the 35 bytes"},
      {"range_binary.ply", little + vertex_bytes + '\3' + binary(0, 1, 77), Error::index_out_of_range,
       "face 0 names vertex 77"},
      {"nan_binary.ply", little + nan_vertices + '\3' + binary(0, 1, 2), Error::non_finite_vertex,
       "vertex 1"},
      {"long_list_binary.ply", little + vertex_bytes + '\377' + binary(0, 1, 2), Error::bad_format,
       "truncated"},
      {"many.ply", ply_header("binary_little_endian", "4000000000") + vertex_bytes, Error::bad_format,
       "truncated"},
      {"minus.ply", ply_header("ascii", "-3"), Error::bad_format, "line 4"},

      {"tiny.stl", "xyz", Error::bad_format, "truncated"},
      {"none.stl", binary_stl(0).substr(0, 84), Error::bad_format, "no triangles"},
      {"cut.stl", binary_stl(1).substr(0, 100), Error::bad_format,
       "truncated: the header promises 1 triangles, 134 bytes"},
      {"many.stl", binary_stl(4000000000u), Error::bad_format, "truncated: the header promises 4000000000"},
      {"nan.stl", binary_stl(1, nan_vertices), Error::non_finite_vertex, "vertex 1"},
      {"cut_ascii.stl", ascii_stl.substr(0, 60), Error::bad_format, "line 5"},
      {"no_end.stl", ascii_stl.substr(0, ascii_stl.size() - 11), Error::bad_format,
       "truncated: ends at line 8"},
      {"nan_ascii.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 nan 0\n", Error::non_finite_vertex,
       "line 4"},

      {"none.gltf", "hello", Error::bad_format, "line 1"},
      {"cut.gltf", gltf(R"("uri":"buffer.bin",)").substr(0, 200), Error::bad_format, "not a valid glTF file"},
      {"absent.gltf", gltf(R"("uri":"absent.bin",)"), Error::io, "absent.bin"},
      {"short.gltf", gltf(R"("uri":"short.bin",)"), Error::bad_format, "truncated: buffers[0]"},
      {"range.gltf", gltf(R"("uri":"bad_index.bin",)"), Error::index_out_of_range,
       "meshes[0].primitives[0]: index 2 names vertex 7"},
      {"cycle.gltf", gltf(R"("uri":"buffer.bin",)", R"("mesh":0,"children":[0])"), Error::bad_format,
       "nodes[0]"},
      {"no_mesh.gltf", gltf(R"("uri":"buffer.bin",)", R"("mesh":5)"), Error::bad_format, "5"},
      {"deep.gltf", std::string(100000, '['), Error::bad_format, "nested"},
      {"no_comma.gltf", gltf(R"("uri":"data:application/octet-stream;base64",)"), Error::bad_format,
       "buffers[0]: a data URI"},
      {"short_data.gltf", gltf(R"("uri":"data:application/octet-stream,AAAA",)"), Error::bad_format,
       "truncated: buffers[0] should have 44 bytes and has 4"},
      {"digits.gltf", gltf(R"("uri":"data:;base64,AAAAAA*A",)"), Error::bad_format,
       "buffers[0]: no base64 from character 6"},
      {"twice.gltf", gltf(R"("uri":"buffer.bin",)", R"("mesh":0,"mesh":1)"), Error::bad_format,
       "two members \"mesh\""},
      {"cut.glb", glb(gltf_buffer()).substr(0, 300), Error::bad_format, "truncated"},
      {"range.glb", glb(gltf_buffer(3)), Error::index_out_of_range, "index 2 names vertex 3"},

      {"cut.obj.gz", gzip(obj).substr(0, 30), Error::bad_format, "truncated"},
      {"damaged.obj.gz", gzip(obj).replace(12, 3, "zzz"), Error::bad_format, "damaged"},
  };
  for (const BadFile& bad : files) {
    SCOPED_TRACE(bad.name);
    const std::string file = directory.write(bad.name, bad.bytes);
    try {
      load_file(file);
      ADD_FAILURE() << "was loaded";
    } catch (const Error& error) {
      const std::string_view sentence = error.what();
      EXPECT_EQ(error.code(), bad.code) << sentence;
      EXPECT_NE(sentence.find(bad.name), std::string_view::npos) << sentence;
      EXPECT_NE(sentence.find(bad.cause), std::string_view::npos) << sentence;
      EXPECT_EQ(sentence.find('\n'), std::string_view::npos) << sentence;
    }
  }
}

TEST(LoadFile, NamesAFileThatIsNotThere) {
  const TemporaryDirectory directory;
  try {
    load_file((directory / "absent.obj"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::io);
    EXPECT_NE(std::string_view(error.what()).find("absent.obj"), std::string_view::npos);
  }
}

TEST(LoadFile, NeverCrashesOnATruncatedFile) {
  const TemporaryDirectory directory;
  directory.write("buffer.bin", gltf_buffer());
  const std::pair<std::string, std::string> files[] = {{"a.obj", obj},
                                                       {"a.ply", ascii_ply},
                                                       {"b.ply", binary_ply},
                                                       {"a.stl", ascii_stl},
                                                       {"b.stl", binary_stl(1)},
                                                       {"a.gltf", gltf(R"("uri":"buffer.bin",)")},
                                                       {"a.glb", glb(gltf_buffer())}};
  for (const auto& [name, bytes] : files) {
    // The last few bytes may be ones that nobody misses: the name behind endsolid.
    for (std::size_t size = 0; size + 4 < bytes.size(); size += 1 + bytes.size() / 40) {
      SCOPED_TRACE(name + " of " + std::to_string(size) + " bytes");
      const std::string file = directory.write(name, bytes.substr(0, size));
      EXPECT_THROW(load_file(file), Error);
    }
  }
}

}  // namespace
}  // namespace workbench
