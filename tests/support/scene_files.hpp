// Scene files made by a test: what is read from them, and how they are refused.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/error.hpp>
#include <kerf/vec.hpp>

#include "support/temporary_directory.hpp"
#include "workbench/formats/load_file.hpp"

namespace kerf_tests {

/// The corners of a triangle.
using Corners = std::array<kerf::Vec3f, 3>;

inline std::vector<Corners> triangles_of(const workbench::Scene& scene) {
  std::vector<Corners> triangles;
  for (const auto& [a, b, c] : scene.triangles)
    triangles.push_back({scene.vertices[a], scene.vertices[b], scene.vertices[c]});
  return triangles;
}

/// Loads a file of that name, which decides the format, with that content.
inline workbench::Scene load_as(const std::string& name, const std::string& content) {
  const TemporaryDirectory directory;
  return workbench::load_file(directory.write(name, content));
}

/// Expects that `read()` throws an error of that code, in one line that tells `cause`.
template <class Read>
void expect_refused(const Read& read, kerf::Error::Code code, const std::string& cause) {
  try {
    read();
    ADD_FAILURE() << "was read";
  } catch (const kerf::Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_NE(std::string(error.what()).find(cause), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
  }
}

}  // namespace kerf_tests
