// A primitive of a glTF mesh: where its vertices are, and its triangles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "workbench/formats/gltf/accessors.hpp"
#include "workbench/formats/gltf/buffers.hpp"
#include "workbench/formats/gltf/document.hpp"

namespace workbench::gltf {

struct Primitive {
  std::string name;  ///< in errors
  Elements positions;

  /// What the morph targets add to positions, in as far as the file gives it.
  std::vector<std::optional<Elements>> targets;

  /// Joints and their weights: four of each a set.
  std::vector<std::pair<Elements, Elements>> influences;

  enum class Kind { other, triangles, strip, fan } kind = Kind::triangles;  ///< other: points or lines
  std::optional<Elements> indices;
  std::optional<std::vector<std::uint32_t>> unpacked_indices;  ///< by Draco, of triangles

  std::uint64_t corners = 0;    ///< how many indices, or vertices if there are none
  std::uint64_t triangles = 0;  ///< how many they make
};

/// Reads what a primitive says. Its indices are not looked at yet.
Primitive read_primitive(const Document& document, Buffers& buffers, const Object& object);

/// Appends the triangles of a primitive whose vertices begin with number `first_vertex`. Throws if one of
/// them names a vertex that is not there.
void append_triangles(const Document& document, const Primitive& primitive, std::uint32_t first_vertex,
                      std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace workbench::gltf
