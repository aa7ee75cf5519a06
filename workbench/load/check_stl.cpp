#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>
#include <kerf/error.hpp>

#include "workbench/load/checks.hpp"
#include "workbench/load/text.hpp"

namespace workbench {
namespace {

using kerf::Error;

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

std::uint32_t promised_triangles(std::string_view bytes) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    count |= std::uint32_t{static_cast<unsigned char>(bytes[80 + i])} << 8 * i;
  }
  return count;
}

void check_text(const std::filesystem::path& file, std::string_view bytes) {
  Lines lines(bytes);
  std::size_t facets = 0, vertices = 0;
  bool in_solid = false, in_facet = false;
  const auto fail = [&](std::string_view what) {
    throw Error(Error::bad_format, fmt::format("{}: line {}: {}", file.string(), lines.number(), what));
  };
  while (auto line = lines.next()) {
    std::string_view rest = *line;
    const std::string_view keyword = take_word(rest);
    if (keyword == "solid") {
      in_solid = true;
    } else if (keyword == "endsolid") {
      in_solid = false;
    } else if (keyword == "facet") {
      if (in_facet) fail(fmt::format("facet {} has no end", facets));
      in_facet = true;
      vertices = 0;
    } else if (keyword == "vertex") {
      ++vertices;
      for (int axis = 0; axis < 3; ++axis) {
        const std::string_view word = take_word(rest);
        const auto value = to_number<double>(word);
        if (word.empty()) fail(fmt::format("a vertex of facet {} has fewer than three coordinates", facets));
        if (!value) fail(fmt::format("a vertex of facet {}: '{}' is not a number", facets, word));
        if (!std::isfinite(static_cast<float>(*value))) {
          throw Error(Error::non_finite_vertex,
                      fmt::format("{}: line {}: a vertex of facet {} is not finite: {}", file.string(),
                                  lines.number(), facets, word));
        }
      }
    } else if (keyword == "endfacet") {
      if (!in_facet || vertices != 3)
        fail(fmt::format("facet {} has {} vertices, not three", facets, vertices));
      in_facet = false;
      ++facets;
    }
  }
  if (in_solid || in_facet) {
    throw Error(Error::bad_format,
                fmt::format("{}: truncated: ends at line {}, after {} facets, without endsolid",
                            file.string(), lines.number(), facets));
  }
}

}  // namespace

void check_stl(const std::filesystem::path& file, std::string_view bytes) {
  // Binary files too may begin with the word solid; their length tells them apart.
  const bool has_header = bytes.size() >= header_bytes;
  if (has_header && bytes.size() == header_bytes + triangle_bytes * promised_triangles(bytes)) {
    if (bytes.size() == header_bytes)
      throw Error(Error::bad_format, fmt::format("{}: has no triangles", file.string()));
    return;
  }
  std::string_view start = bytes.substr(0, 256);
  if (take_word(start) == "solid") return check_text(file, bytes);
  if (!has_header) {
    throw Error(Error::bad_format,
                fmt::format("{}: truncated: a binary .stl file has {} bytes or more, this one {}",
                            file.string(), header_bytes, bytes.size()));
  }
  const std::uint64_t promised = promised_triangles(bytes);
  const std::uint64_t needed = header_bytes + triangle_bytes * promised;
  throw Error(Error::bad_format,
              fmt::format("{}: {}: the header promises {} triangles, {} bytes in all, but there are {}",
                          file.string(), needed > bytes.size() ? "truncated" : "too long", promised, needed,
                          bytes.size()));
}

}  // namespace workbench
