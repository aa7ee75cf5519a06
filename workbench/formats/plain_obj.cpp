#include <cmath>
#include <cstdint>
#include <iterator>
#include <vector>

#include <fmt/format.h>
#include <kerf/error.hpp>

#include "workbench/formats/checks.hpp"
#include "workbench/formats/text.hpp"
#include "workbench/formats/triangulate.hpp"

namespace workbench {
namespace {

using kerf::Error;

// One statement of an .obj file: its keyword, what stands behind it, and its line.
struct Statement {
  std::string_view keyword, arguments;
  std::size_t line;
};

// Calls `visit` for each statement that gives a vertex or a face. `joined` holds a statement that `\`
// continues.
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

// What stands behind the third coordinate, a weight or a colour, is left out.
void append_vertex(std::string& geometry, const std::filesystem::path& file, Statement statement,
                   std::int64_t number) {
  float values[3];
  for (int axis = 0; axis < 3; ++axis) {
    const std::string_view word = take_word(statement.arguments);
    if (word.empty()) {
      throw Error(Error::bad_format, fmt::format("{}: line {}: vertex {} has {} coordinates, not three",
                                                 file.string(), statement.line, number, axis));
    }
    const auto value = to_number<double>(word);  // wider, to tell what is too large from what is no number
    if (!value) {
      throw Error(Error::bad_format, fmt::format("{}: line {}: vertex {}: '{}' is not a number",
                                                 file.string(), statement.line, number, word));
    }
    values[axis] = static_cast<float>(*value);
    if (!std::isfinite(values[axis])) {
      throw Error(Error::non_finite_vertex, fmt::format("{}: line {}: vertex {} is not finite: {}",
                                                        file.string(), statement.line, number, word));
    }
  }
  fmt::format_to(std::back_inserter(geometry), "v {} {} {}\n", values[0], values[1], values[2]);
}

// What stands behind a slash, the number of a texture coordinate or a normal, is left out.
void append_face(std::string& geometry, const std::filesystem::path& file, Statement statement,
                 std::int64_t vertices_so_far, std::int64_t vertices) {
  std::vector<std::int64_t> corners;
  for (std::string_view word; !(word = take_word(statement.arguments)).empty();) {
    const std::string_view vertex = word.substr(0, word.find('/'));
    const auto index = to_number<std::int64_t>(vertex);
    if (!index) {
      throw Error(Error::bad_format, fmt::format("{}: line {}: '{}' is not the number of a vertex",
                                                 file.string(), statement.line, vertex));
    }
    // Positive numbers count from the first vertex of the file, negative ones back from the face.
    if (*index == 0 || *index > vertices || *index < -vertices_so_far) {
      throw Error(Error::index_out_of_range,
                  *index < 0
                      ? fmt::format("{}: line {}: the face names vertex {}, but there are {} before it",
                                    file.string(), statement.line, *index, vertices_so_far)
                      : fmt::format("{}: line {}: the face names vertex {}, but they go from 1 to {}",
                                    file.string(), statement.line, *index, vertices));
    }
    corners.push_back(*index < 0 ? vertices_so_far + 1 + *index : *index);
  }
  if (corners.size() < 3) {
    throw Error(Error::bad_format, fmt::format("{}: line {}: the face has fewer than three vertices",
                                               file.string(), statement.line));
  }
  const auto append = std::back_inserter(geometry);
  if (corners.size() <= most_corners_with_ears) {
    fmt::format_to(append, "f {}\n", fmt::join(corners, " "));
  } else {  // assimp too takes time with the square of the number of corners
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
  if (faces == 0) throw Error(Error::bad_format, fmt::format("{}: has no triangles", file.string()));

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
