#include "workbench/formats/read_ply.hpp"

#include <algorithm>
#include <bit>
#include <string>

#include <gtest/gtest.h>
#include <kerf/error.hpp>

#include "support/scene_files.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Vec3f;
using Triangle = kerf_tests::Corners;

std::vector<Triangle> read(const std::string& bytes) {
  return kerf_tests::triangles_of(kerf_tests::load_as("a.ply", bytes));
}

void expect_error(const std::string& bytes, Error::Code code, const std::string& cause) {
  SCOPED_TRACE(bytes);
  kerf_tests::expect_refused([&] { read(bytes); }, code, cause);
}

template <class... Values>
std::string little(Values... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
  return bytes;
}
template <class... Values>
std::string big(Values... values) {
  std::string bytes;
  const auto add = [&](std::string value) { bytes.append(value.rbegin(), value.rend()); };
  (add(little(values)), ...);
  return bytes;
}

const std::vector<Triangle> unit = {{Vec3f{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string text_header = "ply\nformat ascii 1.0\nelement vertex 3\n" + xyz + faces + "end_header\n";

TEST(ReadPly, ATextBodyIsAStreamOfWords) {
  EXPECT_EQ(read(text_header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), unit);
  EXPECT_EQ(read(text_header + "\n\n\t0\n0 0 1 0 0 0 1\n\n0 3\n0 1\r2"), unit);
  EXPECT_EQ(read(text_header + "0 0 0\n1.0 0 0\n0 +1 0\n3.0 0.0 1 2.0\nand more"), unit);
}

TEST(ReadPly, LinesEndInAnyWay) {
  const std::string text = text_header + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const std::string end : {"\r\n", "\r", "\r\r\n"}) {
    std::string other;
    for (const char c : text) other += c == '\n' ? end : std::string(1, c);
    EXPECT_EQ(read(other), unit);
  }
}

TEST(ReadPly, BinaryBodiesMayBeginWithTheByteOfALineEnd) {
  // A vertex of the shorts 10 = '\n' or 13 = '\r' first.
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    for (const std::int16_t first : {std::int16_t{10}, std::int16_t{13}}) {
      std::string
          header =
              "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty short x\nproperty short y\n"
              "property short z\n" +
              faces + "end_header\n",
          other;
      for (const char c : header) other += c == '\n' ? end : std::string(1, c);
      const auto zero = std::int16_t{0}, one = std::int16_t{1};
      const auto x = static_cast<float>(first);
      EXPECT_EQ(
          read(other + little(first, zero, zero, one, zero, zero, zero, one, zero) + '\3' + little(0, 1, 2)),
          (std::vector<Triangle>{{Vec3f{x, 0, 0}, {1, 0, 0}, {0, 1, 0}}}));
    }
  }
}

TEST(ReadPly, HeadersMayHaveBlanksAndBlankLines) {
  EXPECT_EQ(
      read("\xef\xbb\xbfply \n\nformat ascii 1.0\t\n comment x\nthat goes on\nobj_info y\n  element  vertex "
           "3 \n" +
           xyz + "\n" + faces + "element edge 0\nelement none 5\nend_header \n0 0 0 1 0 0 0 1 0 3 0 1 2"),
      unit);
}

TEST(ReadPly, WhatNobodyNeedsIsNotJudged) {
  EXPECT_EQ(
      read("ply\nformat ascii 1.0\nelement camera 2\nproperty float view\nproperty list uchar int "
           "of\nelement vertex 4\n"
           "property float nx\n" +
           xyz + "property uchar red\nproperty list int float w\n" + faces +
           "property float quality\nend_header\n-1.#IND 2 a b nan 0\n"
           "nan 0 0 0 999 0\n-1.#IND 1 0 0 red 1 x\n1.#QNAN 0 1 0 -7 0\n0 nan nan inf 0 0\n3 0 1 2 ?\n"),
      unit);
}

TEST(ReadPly, ElementsStandInAnyOrder) {
  EXPECT_EQ(read("ply\nformat ascii 1.0\n" + faces + "element vertex 3\n" + xyz +
                 "end_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n"),
            unit);
  expect_error("ply\nformat ascii 1.0\n" + faces + "element vertex 3\n" + xyz +
                   "end_header\n3 0 1 3\n0 0 0\n1 0 0\n0 1 0\n",
               Error::index_out_of_range, "line 10: face 0 names vertex 3, but there are 3");
}

template <class Number>
void expect_type(const std::string& name) {
  const std::string body =
      "element vertex 3\nproperty " + name + " y\nproperty " + name + " z\nproperty " + name + " x\n";
  const auto zero = Number{0}, one = Number{1};
  EXPECT_EQ(read("ply\nformat binary_little_endian 1.0\n" + body + faces + "end_header\n" +
                 little(zero, zero, zero, zero, zero, one, one, zero, zero) + '\3' + little(0, 1, 2)),
            unit)
      << name;
  EXPECT_EQ(read("ply\nformat binary_big_endian 1.0\n" + body + faces + "end_header\n" +
                 big(zero, zero, zero, zero, zero, one, one, zero, zero) + '\3' + big(0, 1, 2)),
            unit)
      << name;
  if (!std::is_integral_v<Number>) return;
  const std::string lists =
      "element vertex 3\n" + xyz + "element face 1\nproperty list " + name + " " + name + " vertex_index\n";
  EXPECT_EQ(read("ply\nformat binary_big_endian 1.0\n" + lists + "end_header\n" +
                 big(0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f) + big(Number{3}, zero, one, Number{2})),
            unit)
      << name;
}

TEST(ReadPly, EveryTypeIsReadInEitherByteOrder) {
  expect_type<std::int8_t>("char");
  expect_type<std::uint8_t>("uint8");
  expect_type<std::int16_t>("short");
  expect_type<std::uint16_t>("ushort");
  expect_type<std::int32_t>("int");
  expect_type<std::uint32_t>("uint32");
  expect_type<std::int64_t>("int64");
  expect_type<std::uint64_t>("uint64");
  expect_type<float>("float32");
  expect_type<double>("double");
}

TEST(ReadPly, StripsAreTriangles) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 6\n" + xyz +
      "element tristrips 1\n"
      "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n5 5 5\n";
  const Vec3f p[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}, {5, 5, 5}};
  EXPECT_EQ(read(header + "11 0 1 2 3 -1 0 1 -1 5 4 3\n"),
            (std::vector<Triangle>{{p[0], p[1], p[2]}, {p[2], p[1], p[3]}, {p[5], p[4], p[3]}}));
  EXPECT_EQ(read(header + "9 2 3 4 -1 -1 0 1 -1 5\n"), (std::vector<Triangle>{{p[2], p[3], p[4]}}));
  expect_error(header + "3 0 1 -2\n", Error::index_out_of_range, "names vertex -2");
}

TEST(ReadPly, CountsAreNotBelievedBeyondTheFile) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const std::string begin = std::string("ply\nformat ") + format + " 1.0\n";
    expect_error(begin + "element vertex 4000000000\n" + xyz + faces + "end_header\n0 0 0\n",
                 Error::bad_format, "truncated");
    expect_error(begin + "element vertex 1\n" + xyz +
                     "element face 4000000000\nproperty list uchar int vertex_index\nend_header\n"
                     "0 0 0 0 0 0 0",
                 Error::bad_format, "truncated");
    expect_error(begin + "element junk 4000000000\nproperty list int int x\nelement vertex 1\n" + xyz +
                     faces + "end_header\n0 0 0",
                 Error::bad_format, "truncated");
  }
  expect_error(text_header + "0 0 0\n1 0 0\n0 1 0\n999999999999 0 1 2\n", Error::bad_format,
               "truncated: line 13: face 0 of 1");
}

TEST(ReadPly, HeadersWithoutSenseAreRefused) {
  const std::string begin = "ply\nformat ascii 1.0\n";
  expect_error("plyx\n", Error::bad_format, "line 1");
  expect_error("ply\nformat utf8 1.0\n", Error::bad_format, "line 2: 'utf8'");
  expect_error("ply\nelement vertex 3\nend_header\n", Error::bad_format, "names no format");
  expect_error(begin + "element vertex 3\npropertee float x\nend_header\n", Error::bad_format,
               "line 4: 'propertee'");
  expect_error(begin + "property float x\nend_header\n", Error::bad_format,
               "line 3: a property of no element");
  expect_error(begin + "element vertex 3\nproperty half x\nend_header\n", Error::bad_format,
               "line 4: 'half'");
  expect_error(begin + "element vertex 3\nproperty list float int x\nend_header\n", Error::bad_format,
               "line 4: the length");
  expect_error(begin + "element vertex -3\nend_header\n", Error::bad_format, "line 3: '-3'");
  expect_error(begin + "element vertex\nend_header\n", Error::bad_format, "line 3: ''");
  expect_error(begin + "element vertex 3\nproperty float x\nproperty float y\n" + faces + "end_header\n",
               Error::bad_format, "one z");
  expect_error(begin + "element vertex 3\n" + xyz + "end_header\n0 0 0\n1 0 0\n0 1 0\n", Error::bad_format,
               "no triangles");
  expect_error(begin + "element vertex 3\n" + xyz +
                   "element face 1\nproperty list uchar float vertex_indices\nend_header\n",
               Error::bad_format, "no triangles");
}

}  // namespace
}  // namespace workbench
