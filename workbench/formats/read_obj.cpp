#include "workbench/formats/read_obj.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "workbench/base/parallel.hpp"
#include "workbench/base/raise.hpp"
#include "workbench/formats/faces.hpp"
#include "workbench/formats/numbers.hpp"
#include "workbench/formats/text.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Vec3f;

/// Parts of this size are read at once, each by one thread. Larger ones take more memory, smaller ones more
/// time.
constexpr std::size_t part_bytes = std::size_t{1} << 20;

/// Corners count from the file's first vertex, or back from where the face stands; the latter are kept as
/// what they are relative to the part's first vertex until it is known which that is. Both are below 2^30.
constexpr std::uint32_t relative_mark = std::uint32_t{1} << 31;
constexpr std::int64_t relative_zero = std::int64_t{1} << 30, max_vertices = std::int64_t{1} << 30;

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
constexpr std::uint32_t absent =
    std::numeric_limits<std::uint32_t>::max();  ///< a corner that no vertex can be

// A part of the file and what was read in it.
struct Part {
  std::string_view text;
  std::vector<Vec3f> vertices, remainders;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::pair<std::size_t, std::uint32_t>> polygons;  ///< triangles before it, number of corners
  std::vector<std::uint32_t> polygon_corners;
  std::size_t small_faces = 0, lines_and_points = 0, free_forms = 0;

  const char* wrong = nullptr;  ///< where reading stopped, and why
  Error::Code code = Error::bad_format;
  std::string cause;
};

// Reads statements of one part. A statement ends with its line; a `\` before the end of the line continues
// it.
class PartReader {
 public:
  explicit PartReader(Part& part) : part_(part), at_(part.text.data()), end_(at_ + part.text.size()) {}

  /// Reads on to the end, or until it has read the vertex or the face of that number in the part, and returns
  /// where that begins. Faces of fewer than three corners do not count.
  const char* read(std::size_t last_vertex = none, std::size_t last_face = none) {
    while (at_ != end_ && part_.wrong == nullptr) {
      at_ = skip_spaces(at_, end_);
      if (at_ == end_) break;
      const char* const statement = at_;
      const char* const behind = skip_word(at_, end_);
      const std::size_t length = static_cast<std::size_t>(behind - at_);
      if (*at_ == 'v' && length == 1) {
        at_ = behind;
        read_vertex();
        if (part_.vertices.size() > last_vertex) return statement;
      } else if (*at_ == 'f' && (length == 1 || (length == 2 && at_[1] == 'o'))) {  // fo: of old files
        at_ = behind;
        read_face();
        if (part_.triangles.size() + part_.polygons.size() > last_face) return statement;
      } else if ((*at_ == 'l' || *at_ == 'p') && length == 1) {
        ++part_.lines_and_points;
      } else if (*at_ == 'c' || *at_ == 's') {
        const std::string_view keyword(at_, length);
        part_.free_forms += keyword == "curv" || keyword == "curv2" || keyword == "surf";
      }
      if (part_.wrong == nullptr) at_ = find_line_end(at_, end_);
    }
    return end_;
  }

 private:
  // Blanks, and ends of lines that a `\` undoes.
  void skip_gap() {
    for (;;) {
      at_ = skip_blanks(at_, end_);
      if (at_ == end_ || *at_ != '\\') return;
      const char* const line_end = skip_blanks(at_ + 1, end_);
      if (line_end != end_ && !is_line_end(*line_end)) return;
      at_ = line_end;
      while (at_ != end_ && *at_ == '\r') ++at_;  // some files end their lines with several
      if (at_ != end_ && *at_ == '\n') ++at_;
    }
  }
  bool at_statement_end() const { return at_ == end_ || is_line_end(*at_) || *at_ == '#'; }
  static bool ends_word(const char* at, const char* end) {
    return at == end || is_space(*at) || *at == '#' || *at == '\\';
  }

  // A weight or a colour after the third coordinate does not matter. Nor does a vertex without three numbers,
  // unless a face uses it: it is described then.
  void read_vertex() {
    Real values[3];
    bool is_point = true;
    for (Real& value : values) {
      skip_gap();
      value = parse_real(at_, end_);
      if (value.end == nullptr || !ends_word(value.end, end_)) {
        is_point = false;
        break;
      }
      at_ = value.end;
    }
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const Vec3f p =
        is_point ? Vec3f{values[0].nearest, values[1].nearest, values[2].nearest} : Vec3f{nan, nan, nan};
    const Vec3f rest{values[0].remainder(), values[1].remainder(), values[2].remainder()};
    part_.vertices.push_back(p);
    const bool is_exact = rest.x == 0.0f && rest.y == 0.0f && rest.z == 0.0f;
    if (is_exact && part_.remainders.empty()) return;
    if (part_.remainders.empty()) part_.remainders.resize(part_.vertices.size() - 1);
    part_.remainders.push_back(rest);
  }

  // The numbers of a texture coordinate and a normal, which follow slashes, do not matter.
  void read_face() {
    const char* const statement = at_;
    std::uint32_t first[3];
    std::size_t corners = 0;
    const std::size_t polygons_begin = part_.polygon_corners.size();
    for (;;) {
      skip_gap();
      if (at_statement_end()) break;
      const char* const word = at_;
      const Whole index = parse_whole(at_, end_);
      if (index.end == nullptr || !(ends_word(index.end, end_) || *index.end == '/')) {
        return stop(statement, Error::bad_format,
                    fmt::format("'{}' is not the number of a vertex", shown_word(word)));
      }
      at_ = index.end;
      while (!ends_word(at_, end_)) ++at_;
      const std::uint32_t corner = corner_of(index.value);
      if (corner == absent) {
        return stop(statement, Error::index_out_of_range,
                    index.value == 0 ? "the face names vertex 0, but they count from 1"
                                     : fmt::format("the face names vertex {}", index.value));
      }
      if (corners < 3) {
        first[corners] = corner;
      } else {
        if (corners == 3) part_.polygon_corners.insert(part_.polygon_corners.end(), first, first + 3);
        part_.polygon_corners.push_back(corner);
      }
      ++corners;
    }
    if (corners == 3) {
      part_.triangles.push_back({first[0], first[1], first[2]});
    } else if (corners < 3) {
      ++part_.small_faces;
    } else {
      part_.polygons.emplace_back(part_.triangles.size(),
                                  static_cast<std::uint32_t>(part_.polygon_corners.size() - polygons_begin));
    }
  }

  std::uint32_t corner_of(std::int64_t index) const {
    if (index > 0) return index <= max_vertices ? static_cast<std::uint32_t>(index - 1) : absent;
    const std::int64_t relative = static_cast<std::int64_t>(part_.vertices.size()) + index + relative_zero;
    return index == 0 || relative < 0 ? absent : relative_mark | static_cast<std::uint32_t>(relative);
  }

  std::string_view shown_word(const char* word) const {
    const char* behind = word;
    while (!ends_word(behind, end_)) ++behind;
    return shown({word, static_cast<std::size_t>(std::max(behind, std::min(word + 1, end_)) - word)});
  }

  void stop(const char* where, Error::Code code, std::string cause) {
    part_.wrong = where;
    part_.code = code;
    part_.cause = std::move(cause);
  }

  Part& part_;
  const char* at_;
  const char* end_;
};

// The text in parts that end with statements.
std::vector<Part> divide(std::string_view text) {
  std::vector<Part> parts;
  const char *begin = text.data(), *const end = begin + text.size();
  while (begin != end) {
    const char* at = begin + std::min(part_bytes, static_cast<std::size_t>(end - begin));
    for (;;) {
      at = find_line_end(at, end);
      if (at == end) break;
      const char* last = at;  // behind what is not blank
      while (last != begin && is_space(last[-1])) --last;
      while (at != end && is_space(*at)) ++at;
      if (last == begin || last[-1] != '\\') break;
    }
    parts.emplace_back().text = {begin, static_cast<std::size_t>(at - begin)};
    begin = at;
  }
  return parts;
}

class ObjReader {
 public:
  ObjReader(const std::filesystem::path& file, const FileBytes& bytes)
      : file_(file), bytes_(bytes), parts_(divide(without_byte_order_mark(bytes.view()))) {}

  ReadMesh read() {
    parallel_for(parts_.size(), [&](std::size_t i) {
      PartReader(parts_[i]).read();
      bytes_.release(parts_[i].text);
    });
    std::size_t vertices = 0, triangles = 0;
    bool is_rounded = false;
    for (const Part& part : parts_) {
      if (part.wrong != nullptr) raise(part.code, file_, "line {}: {}", line_of(part.wrong), part.cause);
      vertices += part.vertices.size();
      triangles += part.triangles.size();
      is_rounded = is_rounded || !part.remainders.empty();
    }
    if (vertices >= static_cast<std::size_t>(max_vertices))
      raise(Error::too_large, file_, "has 2^30 vertices or more");
    vertices_ = vertices;
    ReadMesh mesh;
    mesh.vertices.reserve(vertices);
    if (is_rounded) mesh.remainders.reserve(vertices);
    Faces faces;
    faces.reserve(triangles);
    for (Part& part : parts_) {
      first_vertex_.push_back(mesh.vertices.size());
      append(part, mesh, faces, is_rounded);
    }
    std::size_t crossing = 0, small_faces = 0, lines_and_points = 0, free_forms = 0;
    mesh.triangles = faces.take_triangles(mesh.vertices, crossing);
    for (const Part& part : parts_) {
      small_faces += part.small_faces;
      lines_and_points += part.lines_and_points;
      free_forms += part.free_forms;
    }
    tell(mesh.contents, small_faces, lines_and_points, free_forms, crossing);
    mesh.describe_vertex = [state = std::make_shared<ObjReader>(std::move(*this))](std::uint32_t vertex) {
      return state->describe(vertex);
    };
    return mesh;
  }

 private:
  std::size_t line_of(const char* at) const { return line_number(bytes_.view(), at); }

  // Moves what a part holds behind what the parts before it hold.
  void append(Part& part, ReadMesh& mesh, Faces& faces, bool is_rounded) {
    const std::size_t first = mesh.vertices.size();
    std::size_t polygon_corner = 0, triangle = 0, polygons = 0;
    const auto resolve = [&](std::span<std::uint32_t> corners) {
      for (std::uint32_t& corner : corners) {
        if (corner & relative_mark) {
          corner = static_cast<std::uint32_t>(static_cast<std::int64_t>(first) + (corner & ~relative_mark) -
                                              relative_zero);
        }
        if (corner >= vertices_) raise_range(part, triangle + polygons, corner);
      }
    };
    const auto add_triangles = [&](std::size_t end) {
      for (; triangle < end; ++triangle) {
        resolve(part.triangles[triangle]);
        faces.add(part.triangles[triangle]);
      }
    };
    for (const auto& polygon : part.polygons) {
      add_triangles(polygon.first);
      const std::span corners = std::span(part.polygon_corners).subspan(polygon_corner, polygon.second);
      resolve(corners);
      faces.add(std::span<const std::uint32_t>(corners));
      polygon_corner += polygon.second;
      ++polygons;
    }
    add_triangles(part.triangles.size());
    mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
    if (is_rounded) {
      mesh.remainders.insert(mesh.remainders.end(), part.remainders.begin(), part.remainders.end());
      mesh.remainders.resize(mesh.vertices.size());
    }
    part.vertices = part.remainders = {};
    part.triangles = {};
    part.polygons = {};
    part.polygon_corners = {};
  }

  // `face` is one of the last part that is appended; those of fewer than three corners do not count.
  [[noreturn]] void raise_range(const Part& part, std::size_t face, std::uint32_t corner) const {
    Part again;
    again.text = part.text;
    const char* const at = PartReader(again).read(none, face);
    const auto before = static_cast<std::int64_t>(first_vertex_.back() + again.vertices.size());
    if (const auto number = static_cast<std::int32_t>(corner); number < 0) {
      raise(Error::index_out_of_range, file_, "line {}: the face names vertex {}, but there are {} before it",
            line_of(at), number - before, before);
    }
    raise(Error::index_out_of_range, file_, "line {}: the face names vertex {}, but they go from 1 to {}",
          line_of(at), std::uint64_t{corner} + 1, vertices_);
  }

  std::string describe(std::uint32_t vertex) const {
    const auto behind = std::upper_bound(first_vertex_.begin(), first_vertex_.end(), vertex);
    const std::size_t number = static_cast<std::size_t>(behind - first_vertex_.begin()) - 1;
    Part part;
    part.text = parts_[number].text;
    const char* at = PartReader(part).read(vertex - first_vertex_[number]);
    const std::size_t line = line_of(at);
    const char* const end = find_line_end(at, part.text.data() + part.text.size());
    std::string_view rest(at, static_cast<std::size_t>(end - at));
    take_word(rest);
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = take_word(rest);
      if (word == "\\") break;  // it goes on in the next line
      if (word.empty() || word.starts_with('#'))
        return fmt::format("line {}: vertex {} has {} coordinates, not three", line, vertex + 1, axis);
      const Real value = parse_real(word.data(), word.data() + word.size());
      if (value.end != word.data() + word.size())
        return fmt::format("line {}: vertex {}: '{}' is not a number", line, vertex + 1, shown(word));
      if (!std::isfinite(value.nearest))
        return fmt::format("line {}: vertex {} is not finite: {}", line, vertex + 1, shown(word));
    }
    return fmt::format("line {}: vertex {} is no point", line, vertex + 1);
  }

  static void tell(SceneContents& contents, std::size_t small_faces, std::size_t lines_and_points,
                   std::size_t free_forms, std::size_t crossing) {
    const auto add = [&](std::size_t count, const char* name, const char* what) {
      if (count != 0) contents.entries.push_back({name, fmt::format("{}{}", count, what)});
    };
    add(small_faces, "faces left out", ", of fewer than three corners");
    add(lines_and_points, "lines and points", " statements, left out");
    add(free_forms, "curves and surfaces", ", left out: free forms are not read");
    add(crossing, "crossing polygons", ", whose outlines cross themselves: covered somehow");
  }

  const std::filesystem::path file_;
  const FileBytes& bytes_;
  std::vector<Part> parts_;
  std::vector<std::size_t> first_vertex_;  ///< of each part
  std::size_t vertices_ = 0;
};

}  // namespace

ReadMesh read_obj(const std::filesystem::path& file, const FileBytes& bytes) {
  return ObjReader(file, bytes).read();
}

}  // namespace workbench
