#include "workbench/formats/read_obj.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "workbench/base/parallel.hpp"
#include "workbench/base/raise.hpp"
#include "workbench/formats/faces.hpp"
#include "workbench/formats/large_vector.hpp"
#include "workbench/formats/numbers.hpp"
#include "workbench/formats/text.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Vec3f;

/// Parts of this size are read by one thread each, so many at once for each thread that none waits for long.
/// What they hold together fits into a second-level cache or two.
constexpr std::size_t parts_per_thread = 8, part_bytes = std::size_t{1} << 18;

/// Corners count from the file's first vertex, or back from where the face stands; the latter are kept as
/// what they are relative to the part's first vertex until it is known which that is. Both are below 2^30.
constexpr std::uint32_t relative_mark = std::uint32_t{1} << 31;
constexpr std::int64_t relative_zero = std::int64_t{1} << 30, max_vertices = std::int64_t{1} << 30;

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
constexpr std::uint32_t absent =
    std::numeric_limits<std::uint32_t>::max();  ///< a corner that no vertex can be

// A part of the file and what was read in it. Another is read into the same memory: fresh memory costs a page
// fault for each 4 KiB.
struct Part {
  std::string_view text;
  std::vector<Vec3f> vertices;
  bool is_rounded = false;        ///< the file's numbers of some vertex are no floats
  bool keeps_remainders = false;  ///< what rounding took is kept below
  std::vector<Vec3f> remainders;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::pair<std::size_t, std::uint32_t>> polygons;  ///< triangles before it, number of corners
  std::vector<std::uint32_t> polygon_corners;
  const char* first_face = nullptr;  ///< its statement
  std::uint32_t largest = 0;         ///< of the corners that count from the file's first vertex
  bool has_relative = false;         ///< there are corners that count back
  std::size_t small_faces = 0, lines_and_points = 0, free_forms = 0;

  const char* wrong = nullptr;  ///< where reading stopped, and why
  Error::Code code = Error::bad_format;
  std::string cause;

  void begin(std::string_view new_text) {
    text = new_text;
    vertices.clear();
    is_rounded = false;
    remainders.clear();
    triangles.clear();
    polygons.clear();
    polygon_corners.clear();
    first_face = nullptr;
    largest = 0;
    has_relative = false;
    small_faces = lines_and_points = free_forms = 0;
  }
};

// Reads statements of one part. A statement ends with its line; a `\` before the end of the line continues
// it.
class PartReader {
 public:
  explicit PartReader(Part& part)
      : part_(part),
        at_(part.text.data()),
        end_(at_ + part.text.size()),
        is_ended_(ends_with_a_line(part.text)) {}

  /// Reads on to the end, or until it has read the vertex or the face of that number in the part, and returns
  /// where that begins. Faces of fewer than three corners do not count.
  const char* read(std::size_t last_vertex = none, std::size_t last_face = none) {
    return is_ended_ ? read_to(FarEnd{end_}, last_vertex, last_face) : read_to(end_, last_vertex, last_face);
  }

 private:
  // Whether a line ends behind all that is no space: then no plain statement reaches the end.
  static bool ends_with_a_line(std::string_view text) {
    while (!text.empty() && is_space(text.back())) {
      if (is_line_end(text.back())) return true;
      text.remove_suffix(1);
    }
    return text.empty();
  }

  // `end` is that of plain statements.
  template <class End>
  const char* read_to(End end, std::size_t last_vertex, std::size_t last_face) {
    while (at_ != end_ && part_.wrong == nullptr) {
      at_ = skip_spaces(at_, end_);
      if (at_ == end_) break;
      const char* const statement = at_;
      const char* const behind = skip_word(at_, end);
      const std::size_t length = static_cast<std::size_t>(behind - at_);
      if (*at_ == 'v' && length == 1) {
        at_ = behind;
        if (!read_plain_vertex(end)) read_vertex();
        if (part_.vertices.size() > last_vertex) return statement;
      } else if (*at_ == 'f' && (length == 1 || (length == 2 && at_[1] == 'o'))) {  // fo: of old files
        if (part_.first_face == nullptr) part_.first_face = at_;
        at_ = behind;
        if (!read_plain_triangle(end)) read_face();
        if (part_.triangles.size() + part_.polygons.size() > last_face) return statement;
      } else if ((*at_ == 'l' || *at_ == 'p') && length == 1) {
        ++part_.lines_and_points;
      } else if (*at_ == 'c' || *at_ == 's') {
        const std::string_view keyword(at_, length);
        part_.free_forms += keyword == "curv" || keyword == "curv2" || keyword == "surf";
      }
      if (part_.wrong == nullptr && (at_ == end_ || !is_line_end(*at_))) at_ = find_line_end(at_, end_);
    }
    return end_;
  }

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
  template <class End>
  static bool ends_word(const char* at, End end) {
    return at == end || is_space(*at) || *at == '#' || *at == '\\';
  }

  // What nearly all vertices are: numbers on one line. False, and nothing was read, if there is anything
  // else.
  template <class End>
  bool read_plain_vertex(End end) {
    const char* at = at_;
    Real values[3];
    for (Real& value : values) {
      value = parse_real(skip_blanks(at, end), end);
      if (value.end == nullptr || value.end == end || !is_space(*value.end)) return false;
      at = value.end;
    }
    at_ = at;
    add_vertex(values);
    return true;
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
    if (!is_point) std::fill(values, values + 3, Real{nan, nan});
    add_vertex(values);
  }

  void add_vertex(const Real (&values)[3]) {
    part_.vertices.push_back({values[0].nearest, values[1].nearest, values[2].nearest});
    for (const Real& value : values) part_.is_rounded |= value.wide != double{value.nearest};
    if (part_.keeps_remainders)
      part_.remainders.push_back({values[0].remainder(), values[1].remainder(), values[2].remainder()});
  }

  // What nearly all faces are: three numbers that count from the file's first vertex, on one line. False, and
  // nothing was read, if there is anything else.
  template <class End>
  bool read_plain_triangle(End end) {
    constexpr std::ptrdiff_t max_digits = 9;  // all such numbers are below `max_vertices`
    const char* at = at_;
    std::uint32_t corners[3];
    for (std::uint32_t& corner : corners) {
      at = skip_blanks(at, end);
      const char* const first = at;
      std::uint64_t number = 0;
      at = read_digits(at, end, number);
      if (number == 0 || at - first > max_digits) return false;
      corner = static_cast<std::uint32_t>(number) - 1;
      if (at != end && *at == '/') {
        while (!ends_word(at, end)) ++at;
      }
      if (at == end || !is_space(*at)) return false;
    }
    at = skip_blanks(at, end);
    if (at == end || !is_line_end(*at)) return false;
    part_.triangles.push_back({corners[0], corners[1], corners[2]});
    part_.largest = std::max({part_.largest, corners[0], corners[1], corners[2]});
    at_ = at;
    return true;
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
    if (corners < 3) {
      ++part_.small_faces;
      return;
    }
    std::span<const std::uint32_t> kept = first;
    if (corners == 3) {
      part_.triangles.push_back({first[0], first[1], first[2]});
    } else {
      kept = std::span(part_.polygon_corners).subspan(polygons_begin);
      part_.polygons.emplace_back(part_.triangles.size(), static_cast<std::uint32_t>(kept.size()));
    }
    for (const std::uint32_t corner : kept)
      if ((corner & relative_mark) == 0) part_.largest = std::max(part_.largest, corner);
  }

  std::uint32_t corner_of(std::int64_t index) {
    if (index > 0) return index <= max_vertices ? static_cast<std::uint32_t>(index - 1) : absent;
    part_.has_relative = true;
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
  const bool is_ended_;
};

// The text in parts that end with statements.
std::vector<std::string_view> divide(std::string_view text) {
  std::vector<std::string_view> parts;
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
    parts.emplace_back(begin, static_cast<std::size_t>(at - begin));
    begin = at;
  }
  return parts;
}

class ObjReader {
 public:
  ObjReader(const std::filesystem::path& file, const FileBytes& bytes)
      : file_(file), bytes_(bytes), texts_(divide(without_byte_order_mark(bytes.view()))) {}

  ReadMesh read() {
    const std::size_t threads = thread_count();
    const std::size_t at_once = std::min(texts_.size(), threads == 1 ? 1 : parts_per_thread * threads);
    std::vector<Part> parts(at_once), before(at_once);
    ReadMesh mesh;
    Faces faces;
    std::size_t read_before = 0;
    const auto append_before = [&] {
      for (std::size_t i = 0; i < read_before; ++i) append(before[i], mesh, faces);
    };
    for (std::size_t begin = 0; begin < texts_.size(); begin += at_once) {
      const std::size_t count = std::min(at_once, texts_.size() - begin);
      parallel_for(1 + count, [&](std::size_t i) {
        if (i == 0) return append_before();  // one thread, while others read on
        parts[i - 1].begin(texts_[begin + i - 1]);
        PartReader(parts[i - 1]).read();
        bytes_.release(parts[i - 1].text);
      });
      read_before = count;
      parts.swap(before);
    }
    append_before();
    if (mesh.vertices.size() >= static_cast<std::size_t>(max_vertices))
      raise(Error::too_large, file_, "has 2^30 vertices or more");
    vertices_ = mesh.vertices.size();
    for (std::size_t part = 0; part < texts_.size(); ++part)
      if (largest_corner_[part] >= vertices_) raise_range(part);
    std::size_t crossing = 0;
    mesh.triangles = faces.take_triangles(mesh.vertices, crossing);
    tell(mesh.contents, small_faces_, lines_and_points_, free_forms_, crossing);
    const auto state = std::make_shared<ObjReader>(std::move(*this));
    mesh.describe_vertex = [state](std::uint32_t vertex) { return state->describe(vertex); };
    if (state->is_rounded_)
      mesh.remainders_of = [state](std::span<const std::uint32_t> vertices) {
        return state->remainders(vertices);
      };
    return mesh;
  }

 private:
  std::size_t line_of(const char* at) const { return line_number(bytes_.view(), at); }

  // A corner of a part whose first vertex has that number; one before the file's first vertex becomes a large
  // number, as one behind its last is.
  static std::uint32_t resolved(std::uint32_t corner, std::size_t first) {
    if ((corner & relative_mark) == 0) return corner;
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(first) + (corner & ~relative_mark) -
                                      relative_zero);
  }

  // Appends what a part holds behind what the parts before it hold.
  void append(Part& part, ReadMesh& mesh, Faces& faces) {
    if (part.wrong != nullptr) raise(part.code, file_, "line {}: {}", line_of(part.wrong), part.cause);
    const std::size_t first = mesh.vertices.size();
    first_vertex_.push_back(first);
    small_faces_ += part.small_faces;
    lines_and_points_ += part.lines_and_points;
    free_forms_ += part.free_forms;
    if (part.has_relative) {
      const auto resolve = [&](std::span<std::uint32_t> corners) {
        for (std::uint32_t& corner : corners)
          part.largest = std::max(part.largest, corner = resolved(corner, first));
      };
      for (auto& triangle : part.triangles) resolve(triangle);
      resolve(part.polygon_corners);
    }
    largest_corner_.push_back(part.largest);
    // Where all that follows is like what `more` were read from, from `begin` on, there is room for it. A few
    // lines at the end of the part say little.
    const auto room = [&](std::size_t have, std::size_t more, const char* begin) {
      const char* const part_end = part.text.data() + part.text.size();
      begin = std::min(begin, part_end - part.text.size() / 16);
      const double bytes = static_cast<double>(part_end - begin);
      const double rest = static_cast<double>(bytes_.view().data() + bytes_.view().size() - begin);
      return have + more + static_cast<std::size_t>(1.05 * static_cast<double>(more) * rest / bytes);
    };
    std::size_t polygon_corner = 0, triangle = 0;
    if (!faces.has_room_for(part.triangles.size()))
      faces.reserve(room(faces.triangles(), part.triangles.size(), part.first_face));
    const auto add_triangles = [&](std::size_t end) {
      faces.add(std::span(part.triangles).subspan(triangle, end - triangle));
      triangle = end;
    };
    for (const auto& polygon : part.polygons) {
      add_triangles(polygon.first);
      faces.add(std::span<const std::uint32_t>(part.polygon_corners).subspan(polygon_corner, polygon.second));
      polygon_corner += polygon.second;
    }
    add_triangles(part.triangles.size());
    if (mesh.vertices.capacity() - first < part.vertices.size())
      reserve_large(mesh.vertices, room(first, part.vertices.size(), part.text.data()));
    mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
    is_rounded_ |= part.is_rounded;
  }

  // For a part with a corner that is none of the file's vertices: names the first such.
  [[noreturn]] void raise_range(std::size_t number) const {
    Part part;
    part.text = texts_[number];
    PartReader(part).read();
    const std::size_t first = first_vertex_[number];
    const auto is_wrong = [&](std::uint32_t corner) { return resolved(corner, first) >= vertices_; };
    std::size_t face = 0, triangle = 0, polygon_corner = 0;
    std::uint32_t corner = 0;
    const auto find_in = [&](std::span<const std::uint32_t> corners) {
      const auto found = std::find_if(corners.begin(), corners.end(), is_wrong);
      if (found == corners.end()) return ++face, false;
      corner = resolved(*found, first);
      return true;
    };
    const auto find_in_triangles = [&](std::size_t end) {
      while (triangle < end)
        if (find_in(part.triangles[triangle++])) return true;
      return false;
    };
    bool found = false;
    for (const auto& polygon : part.polygons) {
      found = find_in_triangles(polygon.first) ||
              find_in(std::span(part.polygon_corners).subspan(polygon_corner, polygon.second));
      if (found) break;
      polygon_corner += polygon.second;
    }
    if (!found) find_in_triangles(part.triangles.size());

    Part again;
    again.text = part.text;
    const char* const at = PartReader(again).read(none, face);
    const auto before = static_cast<std::int64_t>(first + again.vertices.size());
    if (const auto negative = static_cast<std::int32_t>(corner); negative < 0) {
      raise(Error::index_out_of_range, file_, "line {}: the face names vertex {}, but there are {} before it",
            line_of(at), negative - before, before);
    }
    raise(Error::index_out_of_range, file_, "line {}: the face names vertex {}, but they go from 1 to {}",
          line_of(at), std::uint64_t{corner} + 1, vertices_);
  }

  // The number of the part that a vertex is in.
  std::size_t part_of(std::uint32_t vertex) const {
    const auto behind = std::upper_bound(first_vertex_.begin(), first_vertex_.end(), vertex);
    return static_cast<std::size_t>(behind - first_vertex_.begin()) - 1;
  }

  // What rounding took from vertices, which ascend.
  std::vector<Vec3f> remainders(std::span<const std::uint32_t> vertices) const {
    std::vector<Vec3f> taken;
    taken.reserve(vertices.size());
    Part part;
    part.keeps_remainders = true;
    std::size_t last = none;  // the part that was read
    for (const std::uint32_t vertex : vertices) {
      const std::size_t number = part_of(vertex);
      if (number != last) {
        part.begin(texts_[number]);
        PartReader(part).read();
        last = number;
      }
      taken.push_back(part.remainders[vertex - first_vertex_[number]]);
    }
    return taken;
  }

  std::string describe(std::uint32_t vertex) const {
    const std::size_t number = part_of(vertex);
    Part part;
    part.text = texts_[number];
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
  std::vector<std::string_view> texts_;  ///< of the parts
  std::vector<std::size_t> first_vertex_;
  std::vector<std::uint32_t> largest_corner_;
  bool is_rounded_ = false;
  std::size_t vertices_ = 0, small_faces_ = 0, lines_and_points_ = 0, free_forms_ = 0;
};

}  // namespace

ReadMesh read_obj(const std::filesystem::path& file, const FileBytes& bytes) {
  return ObjReader(file, bytes).read();
}

}  // namespace workbench
