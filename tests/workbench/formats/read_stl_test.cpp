#include "workbench/formats/read_stl.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <kerf/error.hpp>

#include "support/scene_files.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Vec3f;
using Triangle = kerf_tests::Corners;

Scene load(const std::string& bytes) {
  return kerf_tests::load_as("a.stl", bytes);
}

std::vector<Triangle> read(const std::string& bytes) {
  return kerf_tests::triangles_of(load(bytes));
}

void expect_error(const std::string& bytes, const std::string& cause, Error::Code code = Error::bad_format) {
  SCOPED_TRACE(bytes);
  kerf_tests::expect_refused([&] { read(bytes); }, code, cause);
}

const Triangle unit = {Vec3f{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, wide = {Vec3f{0, 0, 0}, {9, 0, 0}, {0, 1, 0}};

std::string facet(const std::string& normal = "normal 0 0 1", const std::string& x = "1") {
  return "facet " + normal + "\nouter loop\nvertex 0 0 0\nvertex " + x +
         " 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
}

template <class Value>
void append(std::string& bytes, Value value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// The unit triangle and the wide one, after `header`.
std::string binary(std::string header, std::uint32_t promised = 2, float normal = 0.0f,
                   std::uint16_t attribute = 0) {
  header.resize(80, ' ');
  append(header, promised);
  for (const Triangle& triangle : {unit, wide}) {
    for (int i = 0; i < 3; ++i) append(header, normal);
    for (const Vec3f& p : triangle) append(header, p);
    append(header, attribute);
  }
  return header;
}

TEST(ReadStl, TextsAreReadInLettersOfAnySize) {
  EXPECT_EQ(read("solid a\n" + facet() + "endsolid a\n"), std::vector{unit});
  std::string upper = "solid a\n" + facet() + "endsolid a\n";
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  EXPECT_EQ(read(upper), std::vector{unit});
}

TEST(ReadStl, TextsMayBeLaidOutInAnyWay) {
  const std::string text = "solid a\n" + facet() + "endsolid a\n";
  for (const std::string end : {"\r\n", "\r", "\r\r\n"}) {
    std::string other;
    for (const char c : text) other += c == '\n' ? end : std::string(1, c);
    EXPECT_EQ(read(other), std::vector{unit});
  }
  EXPECT_EQ(read("\xef\xbb\xbf \n\n solid facet endsolid 2/3\n\t" + facet() + "\n end solid b"),
            std::vector{unit});
  EXPECT_EQ(read("solid\nfacet outer loop vertex 0 0 0 vertex 1\n0 0 vertex 0 1 0 end loop end facet "
                 "endsolidglued\n"),
            std::vector{unit});
}

TEST(ReadStl, NormalsAreNotJudged) {
  EXPECT_EQ(
      read("solid\n" + facet("normal nan -nan(ind) 1.#QNAN") + facet("normal", "9") + facet("") + "endsolid"),
      (std::vector{unit, wide, unit}));
  EXPECT_EQ(read(binary("x", 2, std::numeric_limits<float>::quiet_NaN(), 0xffff)), (std::vector{unit, wide}));
}

TEST(ReadStl, AllSolidsOfATextAreRead) {
  EXPECT_EQ(read("solid a\nendsolid a\nsolid b\n" + facet() + "endsolid\n\nsolid\n" + facet("", "9") +
                 "endsolid c\n"),
            (std::vector{unit, wide}));
}

TEST(ReadStl, LoopsOfOtherThanThreeVerticesArePolygons) {
  EXPECT_EQ(read("solid\nfacet\nouter loop\nvertex 5 5 5\nvertex 1 1 1\nendloop\nendfacet\n" + facet() +
                 "endsolid"),
            std::vector{unit});
  EXPECT_EQ(read("solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 "
                 "0\nendloop\nendfacet\nendsolid")
                .size(),
            2u);
}

TEST(ReadStl, BinaryFilesMayBeginWithSolid) {
  EXPECT_EQ(read(binary("solid made by a program")), (std::vector{unit, wide}));
  EXPECT_EQ(read(binary("solid\nfacet normal 0 0 1\nouter loop\n")), (std::vector{unit, wide}));
  EXPECT_EQ(read(binary("x") + "bytes behind"), (std::vector{unit, wide}));
  EXPECT_EQ(read(binary("solid") + "bytes behind"), (std::vector{unit, wide}));
  EXPECT_EQ(read(binary("x", 1)), (std::vector{unit}));
}

TEST(ReadStl, NumbersOfTrianglesThatCannotBeAreNamed) {
  expect_error(binary("x", 3), "truncated: the header promises 3 triangles");
  expect_error(binary("solid", 3), "truncated: the header promises 3 triangles");
  expect_error(binary("x", 0), "too long: the header promises 0 triangles");
  expect_error(binary("x", 4'000'000'000u), "promises 4000000000");
  expect_error(binary("x", 0).substr(0, 84), "no triangles");
  expect_error(binary("x").substr(0, 83), "truncated");
}

TEST(ReadStl, ErrorsOfTextsNameLineAndFacet) {
  expect_error("solid\nendsolid\n", "no triangles");
  expect_error("solid a    ", "truncated: ends at line 1, after 0 facets, without endsolid");
  expect_error("solid\n" + facet(), "truncated: ends at line 8, after 1 facets");
  expect_error("solid\n" + facet() + "facet\nouter loop\nvertex 0 zero 0\n",
               "line 11: facet 1: 'zero' is not a number");
  expect_error("solid\n" + facet() + "facet\nouter loop\nvertex 0 0,5 0\n",
               "line 11: facet 1: '0,5' is not a number");
  expect_error("solid\n" + facet() + "facet\nouter loop\nvertex 0 inf 0\n",
               "line 11: a vertex of facet 1 is not finite: inf", Error::non_finite_vertex);
  expect_error("solid\n" + facet() + "triangle\n", "line 9: facet 1: 'triangle' stands where facet should");
  expect_error("solid\nfacet normal 0 0 1\nvertex 0 0 0\n",
               "line 3: facet 0: 'vertex' stands where outer should");
  expect_error("solid\n" + facet() + "endsolid\n" + facet(),
               "line 10: facet 1: 'facet' stands where solid should");
}

TEST(ReadStl, CountsTrianglesThatRoundingFlattens) {
  const auto text = [](const std::string& x) {
    return "solid\nfacet\nouter loop\nvertex 8000000.1 0 0\nvertex " + x +
           " 0 0\nvertex 8000000.2 1 0\nendloop\nendfacet\nendsolid";
  };
  EXPECT_EQ(load(text("8000000.2")).contents.flattened_triangles, 1u);
  EXPECT_EQ(load(text("8000001.2")).contents.flattened_triangles, 0u);
}

}  // namespace
}  // namespace workbench
