#include "workbench/formats/read_gltf.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <kerf/error.hpp>
#include <meshoptimizer.h>
#include <nlohmann/json.hpp>

#include "support/scene_files.hpp"
#include "support/temporary_directory.hpp"
#include "workbench/formats/load_file.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Vec3f;
using Json = nlohmann::json;
using kerf_tests::triangles_of;
using Triangle = kerf_tests::Corners;

// A glTF file in the making: its JSON, and the bytes of its one buffer.
struct Maker {
  Json json = {{"asset", {{"version", "2.0"}}},
               {"scene", 0},
               {"scenes", {{{"nodes", {0}}}}},
               {"nodes", {{{"mesh", 0}}}},
               {"meshes", {{{"primitives", Json::array()}}}},
               {"accessors", Json::array()},
               {"bufferViews", Json::array()}};
  std::string bytes;

  std::size_t add_view(const void* data, std::size_t size, Json members = Json::object()) {
    while (bytes.size() % 4 != 0) bytes += '\0';
    members["buffer"] = 0;
    members["byteOffset"] = bytes.size();
    members["byteLength"] = size;
    bytes.append(static_cast<const char*>(data), size);
    json["bufferViews"].push_back(std::move(members));
    return json["bufferViews"].size() - 1;
  }

  template <class Number>
  std::size_t add(const std::vector<Number>& numbers, int component_type, const char* type,
                  std::size_t components, bool is_normalized = false) {
    const std::size_t view = add_view(numbers.data(), numbers.size() * sizeof(Number));
    Json accessor = {{"bufferView", view},
                     {"componentType", component_type},
                     {"type", type},
                     {"count", numbers.size() / components}};
    if (is_normalized) accessor["normalized"] = true;
    json["accessors"].push_back(std::move(accessor));
    return json["accessors"].size() - 1;
  }
  std::size_t add_points(const std::vector<float>& numbers) { return add(numbers, 5126, "VEC3", 3); }

  Json& add_primitive(std::size_t positions, Json members = Json::object()) {
    members["attributes"]["POSITION"] = positions;
    Json& primitives = json["meshes"][0]["primitives"];
    primitives.push_back(std::move(members));
    return primitives.back();
  }

  std::string gltf(Json buffer) const {
    Json whole = json;
    buffer["byteLength"] = bytes.size();
    whole["buffers"] = Json::array({std::move(buffer)});
    return whole.dump();
  }
  std::string glb() const {
    std::string text = gltf(Json::object());
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return "glTF" + word(2) + word(28 + text.size() + bytes.size()) + word(text.size()) + "JSON" + text +
           word(bytes.size()) + std::string("BIN\0", 4) + bytes;
  }
  static std::string word(std::size_t value) {
    const auto number = static_cast<std::uint32_t>(value);
    return {reinterpret_cast<const char*>(&number), sizeof number};
  }
};

const std::vector<float> unit_points = {0, 0, 0, 1, 0, 0, 0, 1, 0};
const Triangle unit = {Vec3f{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

Maker unit_maker() {
  Maker maker;
  maker.add_primitive(maker.add_points(unit_points));
  return maker;
}

Scene load(const std::string& bytes, const std::string& name = "a.glb") {
  return kerf_tests::load_as(name, bytes);
}

std::vector<Triangle> read(const Maker& maker) {
  return triangles_of(load(maker.glb()));
}

void expect_error(const Maker& maker, Error::Code code, const std::string& cause) {
  SCOPED_TRACE(maker.json.dump());
  kerf_tests::expect_refused([&] { read(maker); }, code, cause);
}

std::string tell(const Scene& scene) {
  std::string text;
  for (const auto& [name, value] : scene.contents.entries) text += name + ": " + value + "\n";
  return text;
}

TEST(ReadGltf, PositionsAreOfEveryComponentType) {
  const auto expect = [](auto one, int type, bool is_normalized, float length) {
    using Number = decltype(one);
    Maker maker;
    const Number zero{0};
    maker.add_primitive(maker.add(std::vector<Number>{zero, zero, zero, one, zero, zero, zero, one, zero},
                                  type, "VEC3", 3, is_normalized));
    EXPECT_EQ(read(maker), (std::vector<Triangle>{{Vec3f{0, 0, 0}, {length, 0, 0}, {0, length, 0}}})) << type;
  };
  for (const bool is_normalized : {false, true}) {
    expect(std::int8_t{127}, 5120, is_normalized, is_normalized ? 1.0f : 127.0f);
    expect(std::int8_t{-128}, 5120, is_normalized, is_normalized ? -1.0f : -128.0f);
    expect(std::uint8_t{255}, 5121, is_normalized, is_normalized ? 1.0f : 255.0f);
    expect(std::int16_t{-32767}, 5122, is_normalized, is_normalized ? -1.0f : -32767.0f);
    expect(std::uint16_t{13107}, 5123, is_normalized, is_normalized ? 0.2f : 13107.0f);
    expect(std::uint32_t{16777217}, 5125, false, 16777216.0f);
    expect(0.1f, 5126, is_normalized, 0.1f);
    expect(0.1, 5130, false, 0.1f);
  }
  Maker maker = unit_maker();
  maker.json["accessors"][0]["componentType"] = 5131;
  expect_error(maker, Error::bad_format, "accessors[0]: component type 5131");
  maker.json["accessors"][0]["componentType"] = 5126;
  maker.json["accessors"][0]["type"] = "VEC2";
  expect_error(maker, Error::bad_format, "accessors[0]: elements of 2 numbers");
}

TEST(ReadGltf, ElementsMayStandApartAndEndWithTheView) {
  // A normal before each position: the last position ends where the view does.
  const std::vector<float> numbers = {9, 9, 9, 0, 0, 0, 9, 9, 9, 1, 0, 0, 9, 9, 9, 0, 1, 0};
  Maker maker;
  maker.add_view(numbers.data(), numbers.size() * sizeof(float), {{"byteStride", 24}});
  maker.json["accessors"].push_back(
      {{"bufferView", 0}, {"byteOffset", 12}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 3}});
  maker.add_primitive(0);
  EXPECT_EQ(read(maker), std::vector{unit});
  maker.json["accessors"][0]["count"] = 4;
  expect_error(maker, Error::bad_format,
               "truncated: accessors[0]: 4 elements of 12 bytes from byte 12 on cannot be in a view of 72");
}

TEST(ReadGltf, IndicesMakeTrianglesStripsAndFans) {
  const auto with = [](int mode, const std::vector<std::uint16_t>& indices) {
    Maker maker;
    const std::size_t positions = maker.add_points({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
    maker.add_primitive(positions, {{"mode", mode}, {"indices", maker.add(indices, 5123, "SCALAR", 1)}});
    maker.add_primitive(maker.add_points(unit_points));  // one more, so that there is always something
    std::vector<Triangle> triangles = read(maker);
    EXPECT_EQ(triangles.back(), unit);
    triangles.pop_back();
    return triangles;
  };
  const Vec3f p[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}};
  EXPECT_EQ(with(4, {0, 1, 2, 4, 3, 2}), (std::vector<Triangle>{{p[0], p[1], p[2]}, {p[4], p[3], p[2]}}));
  EXPECT_EQ(with(4, {0, 1, 2, 4, 3}), (std::vector<Triangle>{{p[0], p[1], p[2]}}));
  EXPECT_EQ(with(5, {0, 1, 2, 3, 4}),
            (std::vector<Triangle>{{p[0], p[1], p[2]}, {p[2], p[1], p[3]}, {p[2], p[3], p[4]}}));
  EXPECT_EQ(with(6, {0, 1, 3, 2}), (std::vector<Triangle>{{p[1], p[3], p[0]}, {p[3], p[2], p[0]}}));
  for (const int mode : {0, 1, 2, 3}) EXPECT_TRUE(with(mode, {0, 1, 2, 3}).empty());
  for (const int mode : {4, 5, 6}) {
    for (const std::vector<std::uint16_t>& few : {std::vector<std::uint16_t>{0}, {0, 1}})
      EXPECT_TRUE(with(mode, few).empty());
  }
}

TEST(ReadGltf, IndicesAreWholeNumbersWithinTheVertices) {
  Maker maker;
  const std::size_t positions = maker.add_points(unit_points);
  maker.add_primitive(positions,
                      {{"indices", maker.add(std::vector<std::uint8_t>{0, 1, 2}, 5121, "SCALAR", 1)}});
  maker.add_primitive(positions,
                      {{"indices", maker.add(std::vector<std::uint32_t>{0, 1, 2}, 5125, "SCALAR", 1)}});
  EXPECT_EQ(read(maker), (std::vector{unit, unit}));
  Maker restart = unit_maker();
  restart.add_primitive(
      0, {{"mode", 5},
          {"indices", restart.add(std::vector<std::uint16_t>{0, 1, 2, 65535, 1}, 5123, "SCALAR", 1)}});
  expect_error(restart, Error::index_out_of_range,
               "meshes[0].primitives[1]: index 3 names vertex 65535, but there are 3");
  Maker of_shorts = unit_maker();
  of_shorts.add_primitive(
      0, {{"indices", of_shorts.add(std::vector<std::int16_t>{0, 1, 2}, 5122, "SCALAR", 1)}});
  expect_error(of_shorts, Error::bad_format, "meshes[0].primitives[1]: indices of component type 5122");
}

TEST(ReadGltf, SparseElementsReplaceOthersOrZeros) {
  Maker maker = unit_maker();
  const std::vector<std::uint8_t> numbers = {1, 2};
  const std::vector<float> values = {5, 0, 0, 0, 5, 0};
  const Json sparse = {
      {"count", 2},
      {"indices", {{"bufferView", maker.add_view(numbers.data(), 2)}, {"componentType", 5121}}},
      {"values", {{"bufferView", maker.add_view(values.data(), 24)}}}};
  maker.json["accessors"][0]["sparse"] = sparse;
  const std::vector<Triangle> expected = {{Vec3f{0, 0, 0}, {5, 0, 0}, {0, 5, 0}}};
  EXPECT_EQ(read(maker), expected);
  maker.json["accessors"][0].erase("bufferView");
  EXPECT_EQ(read(maker), expected);
  Maker wrong = maker;
  wrong.json["accessors"][0]["count"] = 2;
  expect_error(wrong, Error::index_out_of_range, "accessors[0].sparse: index 1 is 2, out of range");
  wrong.json["accessors"][0]["count"] = 1;
  expect_error(wrong, Error::bad_format, "accessors[0].sparse: count 2 is out of range");
  wrong = maker;
  wrong.json["accessors"][0]["sparse"]["count"] = 3;
  expect_error(wrong, Error::bad_format, "truncated: accessors[0].sparse.indices");
  wrong = maker;
  wrong.json["accessors"][0]["count"] = 1'000'000'000'000;
  expect_error(wrong, Error::bad_format, "accessors[0]: a count of 1000000000000 without bytes");
}

TEST(ReadGltf, ErrorsAreOneLineWhateverTheFileSpells) {
  Maker maker = unit_maker();
  maker.json["accessors"][0]["type"] = "V\r\n\tEC\x1b[2J";
  expect_error(maker, Error::bad_format, R"(accessors[0]: 'V\r\n\tEC\x1b[2J' is not a type of accessors)");
}

TEST(ReadGltf, NodesMoveWhatIsBelowThem) {
  Maker maker = unit_maker();
  const double half = std::sqrt(0.5);
  maker.json["nodes"] = {{{"children", {1, 2}}, {"translation", {0, 0, 5}}},
                         {{"mesh", 0}, {"scale", {-2, 1, 1}}},
                         {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"children", {3}}},
                         {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1}}}};
  const std::vector<Triangle> triangles = read(maker);
  ASSERT_EQ(triangles.size(), 3u);
  EXPECT_EQ(triangles[0], (Triangle{Vec3f{0, 0, 5}, {-2, 0, 5}, {0, 1, 5}}));
  const auto expect_near = [](const Triangle& triangle, const Triangle& expected) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(triangle[i][axis], expected[i][axis], 1e-6);
    }
  };
  expect_near(triangles[1], {Vec3f{0, 0, 5}, {0, 1, 5}, {-1, 0, 5}});
  expect_near(triangles[2], {Vec3f{0, 10, 5}, {0, 11, 5}, {-1, 10, 5}});
  EXPECT_NE(tell(load(maker.glb())).find("instances: 3 of 1 meshes"), std::string::npos);
}

// One above another: enough triangles for places to take less memory than copies.
Maker layers_maker(std::size_t count) {
  std::vector<float> points;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < unit_points.size(); ++k)
      points.push_back(unit_points[k] + (k % 3 == 2 ? static_cast<float>(i) : 0.0f));
  Maker maker;
  maker.add_primitive(maker.add_points(points));
  return maker;
}

// As `load`, with what several nodes show kept once.
Scene load_kept(const Maker& maker) {
  const TemporaryDirectory directory;
  const auto file = directory / "a.glb";
  write_bytes(file, maker.glb());
  return load_file(file, {}, Repeats::kept);
}

TEST(ReadGltf, WhatSeveralNodesShowIsKeptOnce) {
  constexpr std::size_t count = 8;
  Maker maker = layers_maker(count);
  const double half = std::sqrt(0.5);
  maker.json["meshes"].push_back(maker.json["meshes"][0]);  // shown once
  maker.json["nodes"] = {{{"children", {1, 2, 4, 5}}, {"translation", {0, 0, 5}}},
                         {{"mesh", 0}, {"scale", {-2, 1, 1}}},
                         {{"mesh", 0}, {"rotation", {0, 0, half, half}}, {"children", {3}}},
                         {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1}}},
                         {{"mesh", 1}, {"translation", {1, 2, 3}}},
                         {{"mesh", 0}, {"scale", {0, 1, 1}}}};  // flat: it has no place
  const Scene scene = load_kept(maker);
  ASSERT_TRUE(scene.placed);
  EXPECT_TRUE(scene.triangles.empty());
  EXPECT_EQ(scene.triangle_count(), 5 * count);
  const PlacedMeshes& placed = *scene.placed;
  ASSERT_EQ(placed.meshes.size(), 2u);
  EXPECT_EQ(placed.meshes[0].triangles.size(), 2 * count);  // what is shown once, and what is flat
  EXPECT_EQ(placed.meshes[1].triangles.size(), count);
  EXPECT_EQ(placed.places.size(), 4u);
  Scene copied;
  PlacedMeshes::Mesh flat = flattened(placed, 1000);
  copied.vertices = std::move(flat.vertices);
  copied.triangles = std::move(flat.triangles);
  std::vector<Triangle> found = triangles_of(copied), expected = read(maker);
  const auto by_corners = [](const Triangle& a, const Triangle& b) {
    const auto key = [](const Triangle& t) {
      return std::tuple(t[0].x, t[0].y, t[0].z, t[1].x, t[1].y, t[1].z, t[2].x, t[2].y, t[2].z);
    };
    return key(a) < key(b);
  };
  std::sort(found.begin(), found.end(), by_corners);
  std::sort(expected.begin(), expected.end(), by_corners);
  EXPECT_EQ(found, expected);
  EXPECT_NE(tell(scene).find("instances: 5 of 2 meshes"), std::string::npos) << tell(scene);
}

TEST(ReadGltf, CopiesThatTakeNoMoreMemoryThanPlacesAreMade) {
  Maker maker = unit_maker();
  maker.json["nodes"] = {
      {{"mesh", 0}}, {{"mesh", 0}, {"scale", {-2, 1, 1}}}, {{"mesh", 0}, {"translation", {1, 2, 3}}}};
  const Scene scene = load_kept(maker);
  EXPECT_FALSE(scene.placed);
  EXPECT_EQ(triangles_of(scene), read(maker));
}

TEST(ReadGltf, WhatIsShownOnceIsOneMesh) {
  Maker maker = unit_maker();
  maker.json["meshes"].push_back(maker.json["meshes"][0]);
  maker.json["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"mesh", 1}, {"translation", {1, 2, 3}}}};
  const Scene scene = load_kept(maker);
  EXPECT_FALSE(scene.placed);
  EXPECT_EQ(triangles_of(scene), read(maker));
}

// Weights of morph targets make another mesh of it.
TEST(ReadGltf, MeshesThatNodesPoseDifferentlyAreDifferent) {
  constexpr std::size_t count = 16;
  Maker maker = layers_maker(count);
  std::vector<float> up;
  for (std::size_t i = 0; i < 3 * count; ++i) up.insert(up.end(), {0, 0, 1});
  maker.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", maker.add_points(up)}}};
  maker.json["nodes"] = {{{"children", {1, 2, 3, 4}}},
                         {{"mesh", 0}, {"weights", {1}}},
                         {{"mesh", 0}, {"weights", {1}}, {"translation", {5, 0, 0}}},
                         {{"mesh", 0}, {"weights", {0}}},
                         {{"mesh", 0}}};
  const Scene scene = load_kept(maker);
  ASSERT_TRUE(scene.placed);
  EXPECT_EQ(scene.placed->meshes.size(), 2u);
  EXPECT_EQ(scene.placed->stored_triangles(), 3 * count);
  EXPECT_EQ(scene.triangle_count(), 4 * count);
}

TEST(ReadGltf, TheSceneIsTheOneThatTheFileNames) {
  Maker maker = unit_maker();
  maker.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"scale", {2, 2, 2}}}};
  maker.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  const Triangle twice = {Vec3f{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  EXPECT_EQ(read(maker), std::vector{unit});
  maker.json["scene"] = 1;
  EXPECT_EQ(read(maker), std::vector{twice});
  maker.json.erase("scene");
  EXPECT_EQ(read(maker), std::vector{unit});
  maker.json.erase("scenes");
  EXPECT_EQ(read(maker), (std::vector{unit, twice}));
  maker.json["scene"] = 2;
  maker.json["scenes"] = {{{"nodes", {0}}}};
  expect_error(maker, Error::bad_format, "scene: there is no scenes[2]");
}

TEST(ReadGltf, NodesThatAreNoTreesAreNamed) {
  Maker maker = unit_maker();
  maker.json["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"children", {0}}}};
  expect_error(maker, Error::bad_format, "nodes[0] is its own ancestor");
  maker.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
  expect_error(maker, Error::bad_format, "nodes[2] has two parents, 0 and 1");
  maker.json["nodes"] = {{{"mesh", 7}}};
  expect_error(maker, Error::bad_format, "nodes[0]: there is no meshes[7]: meshes has 1 items");
  maker.json["nodes"] = {{{"mesh", "one"}}};
  expect_error(maker, Error::bad_format, "nodes[0].mesh: \"one\" stands where a whole number should");
  maker.json["nodes"] = {{{"mesh", 0}, {"scale", {1, 2}}}};
  expect_error(maker, Error::bad_format, "nodes[0].scale: 2 numbers, not 3");
}

TEST(ReadGltf, SkinsAreWhereTheirJointsPutThem) {
  for (const bool has_inverses : {false, true}) {
    Maker maker;
    Json& primitive = maker.add_primitive(maker.add_points(unit_points));
    primitive["attributes"]["JOINTS_0"] =
        maker.add(std::vector<std::uint8_t>{0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, 5121, "VEC4", 4);
    primitive["attributes"]["WEIGHTS_0"] = maker.add(
        std::vector<std::uint8_t>{255, 0, 0, 0, 0, 255, 0, 0, 51, 204, 0, 0}, 5121, "VEC4", 4, true);
    // Where a skinned mesh hangs does not matter.
    maker.json["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 100, 100}}, {"children", {1}}},
                           {{"translation", {-100, -100, -98}}, {"children", {2}}},
                           {{"translation", {10, 0, 0}}}};
    maker.json["skins"] = {{{"joints", {1, 2}}}};
    float back = 0.0f;
    if (has_inverses) {
      back = 2.0f;
      std::vector<float> matrices;
      for (int i = 0; i < 2; ++i)
        matrices.insert(matrices.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -2, 1});
      maker.json["skins"][0]["inverseBindMatrices"] = maker.add(matrices, 5126, "MAT4", 16);
    }
    // The joints move by (0 0 2) and (10 0 2); the last vertex hangs by a fifth on the second.
    EXPECT_EQ(read(maker),
              (std::vector<Triangle>{{Vec3f{0, 0, 2 - back}, {11, 0, 2 - back}, {2, 1, 2 - back}}}));
    EXPECT_NE(tell(load(maker.glb())).find("skinned meshes: 1, as their joints pose them"),
              std::string::npos);
    Maker wrong = maker;
    wrong.json["skins"][0]["joints"] = {1};
    expect_error(wrong, Error::index_out_of_range,
                 "meshes[0].primitives[0]: vertex 1 hangs on joint 1, but its skin has 1");
    wrong.json["nodes"][0]["skin"] = 1;
    expect_error(wrong, Error::bad_format, "nodes[0]: there is no skins[1]");
    // Joints whose numbers are no unsigned integers, the last one up to the end of the file.
    for (const int type : {5120, 5122, 5126}) {
      Maker other = maker;
      other.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] =
          type == 5120   ? other.add(std::vector<std::int8_t>(12), type, "VEC4", 4)
          : type == 5122 ? other.add(std::vector<std::int16_t>(12), type, "VEC4", 4)
                         : other.add(std::vector<float>(12), type, "VEC4", 4);
      expect_error(other, Error::bad_format,
                   fmt::format("meshes[0].primitives[0]: joints of component type {}", type));
    }
  }
}

TEST(ReadGltf, MorphTargetsAreWhereDefaultWeightsPutThem) {
  Maker maker;
  Json& primitive = maker.add_primitive(maker.add_points(unit_points));
  primitive["targets"] = {
      {{"POSITION", maker.add_points({0, 0, 1, 0, 0, 1, 0, 0, 1})}},
      {{"NORMAL", 99}},
      {{"POSITION", maker.add(std::vector<std::int8_t>{0, 0, 0, 2, 0, 0, 0, 0, 0}, 5120, "VEC3", 3)}}};
  EXPECT_EQ(read(maker), std::vector{unit});
  maker.json["meshes"][0]["weights"] = {0.5, 1, 1};
  EXPECT_EQ(read(maker), (std::vector<Triangle>{{Vec3f{0, 0, 0.5f}, {3, 0, 0.5f}, {0, 1, 0.5f}}}));
  maker.json["nodes"][0]["weights"] = {2};
  EXPECT_EQ(read(maker), (std::vector<Triangle>{{Vec3f{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}}));
  maker.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = maker.add_points({0, 0, 1});
  expect_error(maker, Error::bad_format,
               "meshes[0].primitives[0].targets[0]: 1 vertices, but the primitive has 3");
}

TEST(ReadGltf, InstancesAreAllThere) {
  Maker maker = unit_maker();
  maker.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  maker.json["nodes"][0]["translation"] = {0, 0, 1};
  Json& attributes = maker.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes["TRANSLATION"] = maker.add_points({0, 0, 0, 5, 0, 0});
  attributes["SCALE"] = maker.add_points({1, 1, 1, -3, 3, 3});
  attributes["ROTATION"] =
      maker.add(std::vector<std::int8_t>{0, 0, 0, 127, 0, 0, 0, 127}, 5120, "VEC4", 4, true);
  EXPECT_EQ(read(maker), (std::vector<Triangle>{{Vec3f{0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
                                                {Vec3f{5, 0, 1}, {2, 0, 1}, {5, 3, 1}}}));
  maker.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
      maker.add_points({1, 1, 1});
  expect_error(maker, Error::bad_format, "different counts");
}

TEST(ReadGltf, InstancesBeyondWhatAHierarchyHoldsAreRefusedBeforeTheyTakeMemory) {
  const TemporaryDirectory directory;
  Maker maker = unit_maker();
  maker.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
      maker.add_points(std::vector<float>(3 * 11, 1));
  const std::string file = directory.write("a.glb", maker.glb());
  EXPECT_EQ(read_gltf(file, FileBytes(file), 11).triangles.size(), 11u);
  try {
    read_gltf(file, FileBytes(file), 10);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::too_large);
    EXPECT_NE(std::string(error.what()).find("nodes[0]: with its 11 instances"), std::string::npos)
        << error.what();
  }
}

TEST(ReadGltf, RequiredExtensionsAreUnderstoodOrNamed) {
  Maker maker = unit_maker();
  for (const char* known : {"KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_transform",
                            "EXT_texture_webp", "KHR_lights_punctual"}) {
    maker.json["extensionsRequired"] = {known};
    EXPECT_EQ(read(maker), std::vector{unit});
  }
  maker.json["extensionsRequired"] = {"KHR_mesh_quantization", "ACME_bent_space"};
  expect_error(maker, Error::bad_format, "requires the extension ACME_bent_space");
  maker.json.erase("extensionsRequired");
  maker.json["extensionsUsed"] = {"ACME_bent_space"};
  EXPECT_EQ(read(maker), std::vector{unit});
}

TEST(ReadGltf, HiddenNodesAreLeftOut) {
  Maker maker = unit_maker();
  maker.json["nodes"] = {
      {{"mesh", 0}, {"children", {1}}},
      {{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}, {"children", {2}}},
      {{"mesh", 0}}};
  EXPECT_EQ(read(maker), std::vector{unit});
  EXPECT_NE(tell(load(maker.glb())).find("nodes left out: 1"), std::string::npos);
}

TEST(ReadGltf, WhatTrianglesDoNotDependOnIsNotJudged) {
  Maker maker = unit_maker();
  maker.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 77;
  maker.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = 78;
  maker.json["meshes"][0]["primitives"][0]["material"] = 9;
  maker.json["animations"] = {{{"channels", {{{"sampler", 4}, {"target", {{"node", 99}}}}}}}};
  maker.json["images"] = {{{"uri", "absent.png"}}};
  maker.json["cameras"] = "none";
  maker.json["buffers"] = Json::array();
  EXPECT_EQ(read(maker), std::vector{unit});
  EXPECT_NE(tell(load(maker.glb())).find("animations: 1, left out"), std::string::npos);
}

TEST(ReadGltf, BuffersAreFoundByAnyUri) {
  const Maker maker = unit_maker();
  const TemporaryDirectory directory;
  const auto expect = [&](const std::string& uri) {
    SCOPED_TRACE(uri);
    EXPECT_EQ(triangles_of(load_file(directory.write("a.gltf", maker.gltf({{"uri", uri}})))),
              std::vector{unit});
  };
  directory.write("my buffer.bin", maker.bytes);
  directory.write("50%.bin", maker.bytes);
  directory.write("a%20b.bin", std::string(36, '\0'));
  directory.write("a b.bin", maker.bytes);
  expect("my buffer.bin");
  expect("my%20buffer.bin");
  expect("50%.bin");
  expect("a%20b.bin");
  // (1 0 0) and (0 1 0) need digits of all kinds less than these; the padding may be missing, or the text
  // broken.
  const std::string digits = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  for (const std::string head :
       {"data:application/octet-stream;base64,", "data:;BASE64,", "data:application/gltf-buffer;base64,"})
    expect(head + digits);
  expect("data:;base64,AAAAAAAAAAAAAAAAAACA\nPwAAAAAAAAAAAAAAAAAAgD8AAAAA");
  expect("data:;base64," + digits + "AA");
  std::string percents = "data:application/octet-stream,";
  for (const char c : maker.bytes) percents += fmt::format("%{:02x}", static_cast<unsigned char>(c));
  expect(percents);
}

TEST(ReadGltf, ABufferThatIsNotThereIsNamed) {
  const Maker maker = unit_maker();
  const TemporaryDirectory directory;
  const auto expect = [&](const Json& buffer, const std::string& cause) {
    try {
      load_file(directory.write("a.gltf", maker.gltf(buffer)));
      ADD_FAILURE() << buffer;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(cause), std::string::npos) << error.what();
    }
  };
  expect(Json::object(), "buffers[0] has no uri");
  expect({{"uri", "absent.bin"}}, "absent.bin");
  expect({{"uri", "/dev/zero"}}, "/dev/zero is not a regular file");
  expect({{"uri", "."}}, "is not a regular file");
  expect({{"uri", "data:;base64,AAAA"}}, "truncated: buffers[0] should have 36 bytes and has 3");
  expect({{"uri", "data:;base64,AA*A"}}, "buffers[0]: no base64 from character 2 of 4");
  expect({{"uri", "data:;base64"}}, "buffers[0]: a data URI without a comma");
}

TEST(ReadGltf, GlbFilesMayHaveChunksAndBytesMore) {
  const std::string glb = unit_maker().glb();
  const auto resized = [&](std::string bytes) { return bytes.replace(8, 4, Maker::word(bytes.size())); };
  EXPECT_EQ(triangles_of(load(glb + "behind")), std::vector{unit});
  EXPECT_EQ(triangles_of(load(resized(glb + Maker::word(4) + "ABCDwxyz"))), std::vector{unit});
  EXPECT_EQ(triangles_of(load(resized(glb + std::string(3, '\0')))), std::vector{unit});
  EXPECT_EQ(triangles_of(load(glb, "a.gltf")), std::vector{unit});  // by another name
  EXPECT_EQ(
      triangles_of(load(
          "\xef\xbb\xbf" +
              unit_maker().gltf({{"uri", "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}),
          "a.gltf")),
      std::vector{unit});
  const auto expect = [&](const std::string& bytes, const std::string& cause) {
    try {
      load(bytes);
      ADD_FAILURE() << cause;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(cause), std::string::npos) << error.what();
    }
  };
  expect(glb.substr(0, glb.size() - 1), "truncated: the header promises");
  expect(resized(glb.substr(0, glb.size() - 1)), "truncated: the chunk at byte");
  expect(std::string(glb).replace(4, 4, Maker::word(1)), "has version 1");
  expect(std::string(glb).replace(16, 4, "JSOM"), "byte 12: the first chunk is not JSON");
}

TEST(ReadGltf, ViewsPackedByMeshoptimizerAreUnpacked) {
  std::vector<float> points;
  std::vector<std::uint32_t> indices;
  for (int i = 0; i < 300; ++i) {
    const auto f = static_cast<float>(i);
    points.insert(points.end(), {f, 0, 0, f, 1, 0, f, 0, 1});
    for (std::uint32_t k = 0; k < 3; ++k) indices.push_back(static_cast<std::uint32_t>(3 * i) + k);
  }
  const std::size_t vertices = points.size() / 3;
  std::vector<unsigned char> packed_points(meshopt_encodeVertexBufferBound(vertices, 12));
  packed_points.resize(
      meshopt_encodeVertexBuffer(packed_points.data(), packed_points.size(), points.data(), vertices, 12));
  std::vector<unsigned char> packed_indices(meshopt_encodeIndexBufferBound(indices.size(), vertices));
  packed_indices.resize(meshopt_encodeIndexBuffer(packed_indices.data(), packed_indices.size(),
                                                  indices.data(), indices.size()));
  std::vector<unsigned char> packed_sequence(meshopt_encodeIndexSequenceBound(indices.size(), vertices));
  packed_sequence.resize(meshopt_encodeIndexSequence(packed_sequence.data(), packed_sequence.size(),
                                                     indices.data(), indices.size()));

  Maker maker;
  const auto add = [&](const std::vector<unsigned char>& packed, std::size_t count, std::size_t stride,
                       const char* mode, Json accessor) {
    const std::size_t view = maker.add_view(packed.data(), packed.size());
    Json& object = maker.json["bufferViews"][view];
    Json extension = {{"buffer", 0},
                      {"byteOffset", object["byteOffset"]},
                      {"byteLength", packed.size()},
                      {"count", count},
                      {"byteStride", stride},
                      {"mode", mode}};
    object = {{"buffer", 1},
              {"byteLength", count * stride},
              {"extensions", {{"EXT_meshopt_compression", extension}}}};
    accessor["bufferView"] = view;
    accessor["count"] = count;
    maker.json["accessors"].push_back(std::move(accessor));
  };
  add(packed_points, vertices, 12, "ATTRIBUTES", {{"componentType", 5126}, {"type", "VEC3"}});
  add(packed_indices, indices.size(), 4, "TRIANGLES", {{"componentType", 5125}, {"type", "SCALAR"}});
  add(packed_sequence, indices.size(), 4, "INDICES", {{"componentType", 5125}, {"type", "SCALAR"}});
  maker.add_primitive(0, {{"indices", 1}});
  maker.add_primitive(0, {{"indices", 2}});
  maker.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  const std::vector<Triangle> triangles = read(maker);
  ASSERT_EQ(triangles.size(), 600u);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto f = static_cast<float>(i % 300);
    // The codec of triangles may begin them with another corner.
    EXPECT_EQ(std::count(triangles[i].begin(), triangles[i].end(), Vec3f{f, 0, 0}), 1) << i;
    EXPECT_EQ(std::count(triangles[i].begin(), triangles[i].end(), Vec3f{f, 1, 0}), 1) << i;
  }
  Maker wrong = maker;
  wrong.bytes[0] = 'x';
  expect_error(wrong, Error::bad_format,
               "bufferViews[0].extensions.EXT_meshopt_compression: its packed bytes are damaged");
  wrong = maker;
  wrong.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = 4'000'000'000;
  expect_error(wrong, Error::bad_format, "4000000000 elements cannot be in");
}

TEST(ReadGltf, JsonThatIsNoneIsNamed) {
  const auto expect = [](const std::string& text, const std::string& cause) {
    try {
      load(text, "a.gltf");
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(cause), std::string::npos) << error.what();
    }
  };
  expect("{\n\"asset\": }", "line 2");
  expect("[]", "is not a JSON object");
  expect("{}", "the file has no asset");
  expect(R"({"asset":{"version":"1.0"}})", "glTF of version 1.0");
  expect(R"({"buffers":{"one":{"uri":"one.bin"}}})", "glTF of version 1.0");
  expect(R"({"asset":{"version":"2.0"},"meshes":{}})", "the file.meshes: {} stands where a list should");
  expect(R"({"asset":{"version":"2.0"},"meshes":[7]})", "meshes[0]: 7 stands where an object should");
  expect(std::string(100'000, '['), "nested too deeply");
}

}  // namespace
}  // namespace workbench
