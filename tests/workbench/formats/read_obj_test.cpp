#include "workbench/formats/read_obj.hpp"

#include <limits>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <kerf/error.hpp>

#include "support/scene_files.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Vec3f;
using Triangle = kerf_tests::Corners;

std::vector<Triangle> read(const std::string& text) {
  return kerf_tests::triangles_of(kerf_tests::load_as("a.obj", text));
}

void expect_error(const std::string& text, Error::Code code, const std::string& cause) {
  SCOPED_TRACE(text);
  kerf_tests::expect_refused([&] { read(text); }, code, cause);
}

const std::vector<Triangle> unit = {{Vec3f{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};

TEST(ReadObj, LinesEndInAnyWay) {
  for (const std::string end : {"\n", "\r\n", "\r", "\r\r\n"}) {
    std::string text;
    for (const char* line : {"v 0 0 0", "", "v 1 0 0", "# nothing", "v 0 1 0", "f 1 2 3"}) text += line + end;
    EXPECT_EQ(read(text), unit);
    EXPECT_EQ(read(text.substr(0, text.size() - end.size())), unit);
  }
  EXPECT_EQ(read("v 0 0 0\r\nv 1 0 0\nv 0 1 0\rf 1 2 3"), unit);
}

// Where a line ends the file, it is read without looking for its end.
TEST(ReadObj, AFileThatEndsAnywhereIsReadAsIfALineEndedThere) {
  const std::string text =
      "v 0 0 0\nv 1.25 -0.5 +3e2 \nvn 0 0 1\nv 0 1 0.123456789012\n\nf 1 2 3\nf 1/4/5 2//6 3\nf -3 -2 -1 1 "
      "\n  ";
  const auto outcome = [](const std::string& part) {
    try {
      std::string told;
      for (const Triangle& triangle : read(part))
        for (const Vec3f& p : triangle) told += fmt::format("{} {} {}, ", p.x, p.y, p.z);
      return told;
    } catch (const Error& error) {
      const std::string sentence = error.what();
      return sentence.substr(sentence.find("a.obj"));  // the folder differs
    }
  };
  for (std::size_t size = 1; size <= text.size(); ++size) {
    const std::string part = text.substr(0, size);
    EXPECT_EQ(outcome(part), outcome(part + "\n")) << part;
  }
}

TEST(ReadObj, AByteOrderMarkHasNoContent) {
  EXPECT_EQ(read("\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), unit);
  EXPECT_EQ(read("\xef\xbb\xbf# made by\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), unit);
}

TEST(ReadObj, ABackslashJoinsLinesOfStatementsOnly) {
  EXPECT_EQ(read("v \\\n0 0 \\ \t\n 0\nv 1\\\r\n 0 0\nv 0 \\\n\\\n1 0\nf 1 \\\n2\\\n 3\\"), unit);
  EXPECT_EQ(read("# c:\\\nv 0 0 0\nv 1 0 0 # d:\\\nv 0 1 0\nusemtl e:\\\nf 1 2 3 # f:\\\n"), unit);
}

TEST(ReadObj, WhatIsNeitherVertexNorFaceIsPassedOver) {
  EXPECT_EQ(read("mtllib a.mtl\no a\ng f 1 2\ns 1\nvt nan\nvn x y z\nvp 1\nv 0 0 0\n v  1\t0 0 0.5 .5 .5 "
                 "1\n\tv 0 1 0 7\n"
                 "curv 0 1 1 2\ncstype bezier\nl 1 2\np 9\nf 1/9/9 2//9 3/\n#f 1 1 1\nf 1 99\nf\n"),
            unit);
  EXPECT_EQ(read("v 0 0 0\nv 1 0 0\nv 0 1 0\nfo 1 2 3\n"), unit);  // as old files call faces
}

TEST(ReadObj, NegativeNumbersCountBackFromTheFace) {
  std::string text;
  std::vector<Triangle> expected;
  for (int i = 0; i < 30'000; ++i) {  // in many parts of the file
    const std::string z = std::to_string(i);
    text += "v 0 0 " + z + "\nv 1 0 " + z + "\nv 0 1 " + z + "\nf " +
            (i % 2 ? "-3 -2 -1" : std::to_string(3 * i + 1) + " -2 " + std::to_string(3 * i + 3)) + "\n";
    const auto f = static_cast<float>(i);
    expected.push_back({Vec3f{0, 0, f}, {1, 0, f}, {0, 1, f}});
  }
  EXPECT_EQ(read(text), expected);
  EXPECT_EQ(read("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"),
            unit);  // positive ones may come before their vertices
}

TEST(ReadObj, AVertexMattersIfAFaceUsesIt) {
  EXPECT_EQ(read("v nan nan nan\nv 0 0 0\nv 1 0 0\nv\nv 0 1 0\nv 1 x\nf 2 3 5\n"), unit);
  const std::string three = "v 0 0 0\nv 1 0 0\n# no vertex\n", face = "\nf 1 2 3\n";
  expect_error(three + "v 0 nan 0" + face, Error::non_finite_vertex, "line 4: vertex 3 is not finite: nan");
  expect_error(three + "v 0 1e39 0" + face, Error::non_finite_vertex, "line 4: vertex 3 is not finite: 1e39");
  expect_error(three + "v 0 -1.#IND 0" + face, Error::non_finite_vertex,
               "line 4: vertex 3 is not finite: -1.#IND");
  expect_error(three + "v 0 0,5 0" + face, Error::bad_format, "line 4: vertex 3: '0,5' is not a number");
  expect_error(three + "v 0 1 # 0" + face, Error::bad_format, "line 4: vertex 3 has 2 coordinates");
}

TEST(ReadObj, ErrorsNameTheLineInLargeFiles) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += "v 0 0 0\n# " + std::to_string(i) + "\n";
  expect_error(text + "f 1 2 3\nf 1\nf 3 100001 -1 7\n", Error::index_out_of_range,
               "line 200003: the face names vertex 100001, but they go from 1 to 100000");
  expect_error(text + "f 1 2 3\nf 1\nf 3 -100001 -1 7\n", Error::index_out_of_range,
               "line 200003: the face names vertex -100001, but there are 100000 before it");
  expect_error(text + "f 1 2 3\nf 1 2 0\n", Error::index_out_of_range,
               "line 200002: the face names vertex 0");
  expect_error(text + "f 1 2 99999999999999999999\n", Error::index_out_of_range,
               "line 200001: the face names vertex");
  expect_error(text + "v inf 0 0\nf -1 1 2\n", Error::non_finite_vertex,
               "line 200001: vertex 100001 is not finite: inf");
}

TEST(ReadObj, CountsTrianglesThatRoundingFlattens) {
  const TemporaryDirectory directory;
  const auto flattened = [&](const std::string& text) {
    return load_file(directory.write("a.obj", text)).contents.flattened_triangles;
  };
  EXPECT_EQ(flattened("v 8000000.1 0 0\nv 8000000.2 0 0\nv 8000000.2 1 0\nf 1 2 3\n"), 1u);
  EXPECT_EQ(flattened("v 8000000 0 0\nv 8000001 0 0\nv 8000001 1.1 0\nf 1 2 3\n"), 0u);
  EXPECT_EQ(flattened("v 0.1 0.1 0.1\nv 0.2 0.2 0.2\nv 0.3 0.3 0.3\nf 1 2 3\n"),
            0u);  // has no area in the file either
  EXPECT_EQ(flattened("v 8000000.1 0 0\nv 8000000.2 0 0\nv 8000000.3 0 0\nf 1 2 3\nf 1 1 2\n"), 0u);
}

// What rounding took is read again where it is asked for: in the right part of the file, by the file's
// numbers.
TEST(ReadObj, CountsTrianglesThatRoundingFlattensInEveryPartOfALargeFile) {
  const TemporaryDirectory directory;
  std::string text;
  constexpr std::size_t count = 20000;
  for (std::size_t i = 0; i < count; ++i) {
    text += "v 9 9 9\nv 8000000.1 0 0\nv 8000000.2 0 0\nv 8000000.2 1 0\nf -3 -2 -1\n";
    text += "v 1.1 0 0\nv 1.2 0 0\nv 1.2 1 0\nf -3 -2 -1\nv 8000000.2 1 0\nf -3 -1 -1\n";
  }
  const Scene scene = load_file(directory.write("a.obj", text));
  EXPECT_EQ(scene.contents.flattened_triangles, count);
  EXPECT_EQ(scene.vertices.size(), 7 * count);
}

}  // namespace
}  // namespace workbench
