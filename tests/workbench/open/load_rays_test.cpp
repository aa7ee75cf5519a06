#include "workbench/open/load_rays.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <kerf/error.hpp>

#include "support/scene_files.hpp"
#include "support/temporary_directory.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Ray;
using kerf::Vec3f;

std::vector<Ray> read(const std::string& text) {
  const TemporaryDirectory directory;
  write_bytes(directory.file("rays.txt"), text);
  return load_rays(directory.file("rays.txt"));
}

TEST(LoadRays, ALineIsARay) {
  const std::vector<Ray> rays =
      read("# from a camera\n0 1 2 3 4 5\r\n\n1e-3,-2,.5, 0 0 -1 7 # to the floor\r1\t2 3 4 5 6 -8 inf");
  ASSERT_EQ(rays.size(), 3u);
  EXPECT_EQ(rays[0].origin, (Vec3f{0, 1, 2}));
  EXPECT_EQ(rays[0].direction, (Vec3f{3, 4, 5}));
  EXPECT_EQ(rays[0].t_min, 0.0f);
  EXPECT_EQ(rays[0].t_max, std::numeric_limits<float>::infinity());
  EXPECT_EQ(rays[1].origin, (Vec3f{1e-3f, -2.0f, 0.5f}));
  EXPECT_EQ(rays[1].t_max, 7.0f);
  EXPECT_EQ(rays[2].t_min, -8.0f);
  EXPECT_EQ(rays[2].t_max, std::numeric_limits<float>::infinity());
}

TEST(LoadRays, WhatIsNoRayIsRefusedByItsLine) {
  const auto expect_error = [](const std::string& text, const std::string& cause) {
    SCOPED_TRACE(text);
    kerf_tests::expect_refused([&] { read(text); }, Error::bad_format, cause);
  };
  expect_error("0 0 0 1 1 1\n1 2 3 4 5\n", "line 2: 5 numbers");
  expect_error("1 2 3 4 5 6 7 8 9", "line 1: more than eight");
  expect_error("\n1 2 3 4 five 6", "line 2: 'five' is no number");
  expect_error("1 2 3 4 5 6x", "line 1: '6x' is no number");
  expect_error("1 2 3 4 5 nan", "line 1: a number is nan");
  expect_error("# nothing\n\n", "holds no rays");
}

}  // namespace
}  // namespace workbench
