#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "workbench/base/raise.hpp"
#include "workbench/formats/checks.hpp"
#include "workbench/formats/text.hpp"
#include "workbench/formats/triangulate.hpp"

namespace workbench {
namespace {

using kerf::Error;

// One statement of an .obj file: its keyword, what follows it, and its line.
struct Statement {
  std::string_view keyword, arguments;
  std::size_t line;
};

// Calls `visit` for each statement that defines a vertex or a face. A `\` at the end of a line continues the
// statement, which is then put together in `joined`.
template <class Visit>
void for_each_statement(std::string_view bytes, Visit&& visit) {
  std::string joined;
  for (Lines lines(bytes); auto line = lines.next();) {
    const std::size_t number = lines.number();
    joined.clear();
    while (line && line->ends_with('\\')) {
      joined.append(line->substr(0, line->size() - 1)).push_back(' ');
      line = lines.next();
    }
    if (!joined.empty()) {
      if (line) joined.append(*line);
      line = joined;
    }
    std::string_view rest = line->substr(0, line->find('#'));
    const std::string_view keyword = take_word(rest);
    if (keyword == "v" || keyword == "f") visit(Statement{keyword, rest, number});
  }
}

// A weight or a colour after the third coordinate is left out.
void append_vertex(std::string& geometry, const std::filesystem::path& file, Statement statement,
                   std::int64_t number) {
  float values[3];
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = take_word(statement.arguments);
    if (word.empty()) {
      raise(Error::bad_format, file, "line {}: vertex {} has {} coordinates, not three", statement.line,
            number, axis);
    }
    const auto value =
        to_number<double>(word);  // wider than float, so that too large a number still is a number
    if (!value) {
      raise(Error::bad_format, file, "line {}: vertex {}: '{}' is not a number", statement.line, number,
            word);
    }
    values[axis] = static_cast<float>(*value);
    if (!std::isfinite(values[axis])) {
      raise(Error::non_finite_vertex, file, "line {}: vertex {} is not finite: {}", statement.line, number,
            word);
    }
  }
  fmt::format_to(std::back_inserter(geometry), "v {} {} {}\n", values[0], values[1], values[2]);
}

// The index of a texture coordinate or a normal, which follows a slash, is left out.
void append_face(std::string& geometry, const std::filesystem::path& file, Statement statement,
                 std::int64_t vertices_so_far, std::int64_t vertices) {
  std::vector<std::int64_t> corners;
  for (std::string_view word; !(word = take_word(statement.arguments)).empty();) {
    const std::string_view vertex = word.substr(0, word.find('/'));
    const auto index = to_number<std::int64_t>(vertex);
    if (!index) {
      raise(Error::bad_format, file, "line {}: '{}' is not the index of a vertex", statement.line, vertex);
    }
    // Positive indices count from the first vertex of the file, negative ones back from the face.
    if (*index < -vertices_so_far) {
      raise(Error::index_out_of_range, file, "line {}: the face names vertex {}, but there are {} before it",
            statement.line, *index, vertices_so_far);
    }
    if (*index == 0 || *index > vertices) {
      raise(Error::index_out_of_range, file, "line {}: the face names vertex {}, but they go from 1 to {}",
            statement.line, *index, vertices);
    }
    corners.push_back(*index < 0 ? vertices_so_far + 1 + *index : *index);
  }
  if (corners.size() < 3) {
    raise(Error::bad_format, file, "line {}: the face has fewer than three vertices", statement.line);
  }
  const auto append = std::back_inserter(geometry);
  if (corners.size() <= max_corners_with_ears) {
    fmt::format_to(append, "f {}\n", fmt::join(corners, " "));
  } else {  // the time that assimp takes grows with the square of the number of corners, too
    for (std::size_t i = 2; i < corners.size(); ++i) {
      fmt::format_to(append, "f {} {} {}\n", corners[0], corners[i - 1], corners[i]);
    }
  }
}

}  // namespace

std::string plain_obj(const std::filesystem::path& file, std::string_view bytes) {
  std::int64_t vertices = 0, faces = 0;
  for_each_statement(bytes,
                     [&](const Statement& statement) { ++(statement.keyword == "v" ? vertices : faces); });
  if (faces == 0) raise(Error::bad_format, file, "has no triangles");

  std::string geometry;
  geometry.reserve(bytes.size());
  std::int64_t so_far = 0;
  for_each_statement(bytes, [&](const Statement& statement) {
    if (statement.keyword == "v") {
      append_vertex(geometry, file, statement, ++so_far);
    } else {
      append_face(geometry, file, statement, so_far, vertices);
    }
  });
  return geometry;
}

}  // namespace workbench
