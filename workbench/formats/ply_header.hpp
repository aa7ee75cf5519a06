// The header of a .ply file, which describes the data that follow it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace workbench {

struct PlyScalarType {
  std::array<std::string_view, 2> names;  ///< of the two generations of the format
  std::size_t bytes;
  bool is_integer;
  bool is_signed;
};

struct PlyProperty {
  std::string_view name;
  const PlyScalarType* type = nullptr;
  const PlyScalarType* count_type = nullptr;  ///< of a list; null for a scalar
};

struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::string_view body;  ///< what follows the header
};

/// The header that `bytes` begin with; its strings are views of `bytes`. Throws `kerf::Error::bad_format`
/// with one line that names the file and the line in it, also if the header describes no vertices with x, y
/// and z, or no faces or strips with lists of vertices.
PlyHeader read_ply_header(const std::filesystem::path& file, std::string_view bytes);

/// True if `property` is the list of the vertices of a face.
bool is_vertex_list(const PlyElement& element, const PlyProperty& property);

/// True if it is the list of the vertices of strips of triangles, each of which ends with -1.
bool is_strip_list(const PlyElement& element, const PlyProperty& property);

}  // namespace workbench
