// What the readers of scene files make.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <kerf/vec.hpp>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// The triangles of a file. Indices are in range; coordinates may be any floats.
struct ReadMesh {
  std::vector<kerf::Vec3f> vertices;

  /// What rounding to floats took from each coordinate; empty where nothing was rounded, or where
  /// `remainders_of` tells it.
  std::vector<kerf::Vec3f> remainders;

  /// The same of the named vertices, which ascend, by a reader that would rather read these again than keep
  /// all: few are ever asked for.
  std::function<std::vector<kerf::Vec3f>(std::span<const std::uint32_t> vertices)> remainders_of;

  using Triangle = std::array<std::uint32_t, 3>;
  std::vector<Triangle> triangles;

  /// What a vertex is called in errors, and what is wrong with one that is no point, if more is known of it
  /// than its number and its coordinates: "line 3: vertex 3 is not finite: nan".
  std::function<std::string(std::uint32_t vertex)> describe_vertex;

  SceneContents contents;

  /// Appends a point, and what rounding takes from it unless nothing ever was rounded.
  void add_vertex(double x, double y, double z) {
    const kerf::Vec3f p{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    add_vertex(p, {static_cast<float>(x - double{p.x}), static_cast<float>(y - double{p.y}),
                   static_cast<float>(z - double{p.z})});
  }
  void add_vertex(const kerf::Vec3f& nearest, const kerf::Vec3f& remainder) {
    const bool is_exact = remainder.x == 0.0f && remainder.y == 0.0f && remainder.z == 0.0f;
    if (!is_exact && remainders.empty()) {
      remainders.reserve(vertices.capacity());
      remainders.resize(vertices.size());
    }
    vertices.push_back(nearest);
    if (!is_exact || !remainders.empty()) remainders.push_back(remainder);
  }
};

}  // namespace workbench
