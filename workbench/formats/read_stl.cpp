#include "workbench/formats/read_stl.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include <fmt/format.h>

#include "workbench/base/raise.hpp"
#include "workbench/formats/check_mesh.hpp"
#include "workbench/formats/faces.hpp"
#include "workbench/formats/join_vertices.hpp"
#include "workbench/formats/numbers.hpp"
#include "workbench/formats/text.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Vec3f;

constexpr std::size_t header_bytes = 84, triangle_bytes = 50, normal_bytes = 12;

/// Triangles that are read before their vertices are joined.
constexpr std::size_t triangles_at_once = 1024;

/// Bytes of the file after which the system is told that they are done with.
constexpr std::size_t release_bytes = std::size_t{1} << 22;

char lower_case(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

// True if `word` is `keyword` in small letters or large ones.
bool is_keyword(std::string_view word, std::string_view keyword) {
  return word.size() == keyword.size() && std::equal(word.begin(), word.end(), keyword.begin(),
                                                     [](char a, char b) { return lower_case(a) == b; });
}

// Reads the grammar of text files: a stream of words, but for names, which end with their lines.
class TextReader {
 public:
  TextReader(const std::filesystem::path& file, const FileBytes& bytes)
      : file_(file),
        bytes_(bytes),
        text_(without_byte_order_mark(bytes.view())),
        at_(text_.data()),
        end_(at_ + text_.size()),
        released_(at_) {}

  ReadMesh read() {
    std::size_t solids = 0;
    for (; next_word(); ++solids) {
      expect("solid");
      read_solid();
    }
    std::size_t crossing = 0;
    const std::size_t small_faces = faces_.without_surface();
    mesh_.vertices = joiner_.take_vertices();
    mesh_.triangles = faces_.take_triangles(mesh_.vertices, crossing);
    const auto tell = [&](std::size_t count, const char* name, const char* what) {
      if (count != 0) mesh_.contents.entries.push_back({name, fmt::format("{}{}", count, what)});
    };
    if (solids > 1) tell(solids, "solids", ", as one mesh");
    tell(small_faces, "facets left out", ", of fewer than three vertices");
    tell(crossing, "crossing facets", ", whose outlines cross themselves: covered somehow");
    return std::move(mesh_);
  }

 private:
  void read_solid() {
    skip_line();  // its name
    for (need_word();; need_word()) {
      if (is_end("solid")) {
        skip_line();
        return;
      }
      if (word_.size() > 8 &&
          is_keyword(word_.substr(0, 8), "endsolid")) {  // the name follows without a blank
        skip_line();
        return;
      }
      expect("facet");
      read_facet();
      ++facet_;
      release();
    }
  }

  void read_facet() {
    // The normal may be missing, or none: it does not matter.
    for (need_word(); !is_keyword(word_, "outer"); need_word()) {
      if (is_keyword(word_, "vertex") || is_keyword(word_, "endfacet") || is_keyword(word_, "facet"))
        expect("outer");
    }
    need_word();
    expect("loop");
    corners_.clear();
    rests_.clear();
    for (need_word(); !is_end("loop"); need_word()) {
      expect("vertex");
      read_vertex();
    }
    need_word();
    if (!is_end("facet")) expect("endfacet");
    numbers_.resize(corners_.size());
    joiner_.add(corners_, numbers_.data());
    if (corners_.size() == 3)
      mesh_.contents.flattened_triangles +=
          is_flattened({corners_[0], corners_[1], corners_[2]}, {rests_[0], rests_[1], rests_[2]});
    faces_.add(std::span<const std::uint32_t>(numbers_));
  }

  void read_vertex() {
    Real values[3];
    for (Real& value : values) {
      at_ = skip_spaces(at_, end_);
      value = parse_real(at_, end_);
      if (value.end == nullptr || !(value.end == end_ || is_space(*value.end))) {
        const std::string_view word(at_, static_cast<std::size_t>(skip_word(at_, end_) - at_));
        if (word.empty()) need_word();
        raise(Error::bad_format, file_, "line {}: facet {}: '{}' is not a number", line(), facet_,
              shown(word));
      }
      if (!std::isfinite(value.nearest)) {
        raise(Error::non_finite_vertex, file_, "line {}: a vertex of facet {} is not finite: {}", line(),
              facet_, std::string_view(at_, static_cast<std::size_t>(value.end - at_)));
      }
      at_ = value.end;
    }
    corners_.push_back({values[0].nearest, values[1].nearest, values[2].nearest});
    rests_.push_back({values[0].remainder(), values[1].remainder(), values[2].remainder()});
  }

  bool next_word() {
    at_ = skip_spaces(at_, end_);
    const char* const behind = skip_word(at_, end_);
    word_ = {at_, static_cast<std::size_t>(behind - at_)};
    at_ = behind;
    return !word_.empty();
  }
  void need_word() {
    if (next_word()) return;
    raise(Error::bad_format, file_, "truncated: ends at line {}, after {} facets, without endsolid",
          last_line_number(text_), facet_);
  }
  void skip_line() { at_ = find_line_end(at_, end_); }

  // endloop, or end loop.
  bool is_end(std::string_view what) {
    if (word_.size() < 3 || !is_keyword(word_.substr(0, 3), "end")) return false;
    if (word_.size() != 3) return is_keyword(word_.substr(3), what);
    need_word();
    expect(what);
    return true;
  }
  void expect(std::string_view keyword) const {
    if (is_keyword(word_, keyword)) return;
    raise(Error::bad_format, file_, "line {}: facet {}: '{}' stands where {} should", line(), facet_,
          shown(word_), keyword);
  }
  std::size_t line() const { return line_number(text_, at_); }

  void release() {
    if (at_ - released_ < static_cast<std::ptrdiff_t>(release_bytes)) return;
    bytes_.release({released_, static_cast<std::size_t>(at_ - released_)});
    released_ = at_;
  }

  const std::filesystem::path& file_;
  const FileBytes& bytes_;
  std::string_view text_;
  const char *at_, *end_, *released_;
  std::string_view word_;
  std::size_t facet_ = 0;
  std::vector<Vec3f> corners_;  ///< of one facet
  std::vector<Vec3f> rests_;    ///< what rounding took from them
  std::vector<std::uint32_t> numbers_;
  VertexJoiner joiner_;
  Faces faces_;
  ReadMesh mesh_;
};

std::uint32_t promised_triangles(std::string_view bytes) {
  std::uint32_t count = 0;
  for (std::size_t i = 4; i-- > 0;) count = count << 8 | static_cast<unsigned char>(bytes[80 + i]);
  return count;
}

float float_at(const char* bytes) {
  std::uint32_t bits = 0;
  for (std::size_t i = 4; i-- > 0;) bits = bits << 8 | static_cast<unsigned char>(bytes[i]);
  return std::bit_cast<float>(bits);
}

ReadMesh read_binary(const FileBytes& bytes, std::size_t triangles) {
  ReadMesh mesh;
  mesh.triangles.resize(triangles);
  VertexJoiner joiner;
  std::vector<Vec3f> corners;
  for (std::size_t begin = 0; begin < triangles; begin += triangles_at_once) {
    const std::size_t count = std::min(triangles_at_once, triangles - begin);
    const std::string_view part =
        bytes.view().substr(header_bytes + begin * triangle_bytes, count * triangle_bytes);
    corners.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const char* at = part.data() + i * triangle_bytes + normal_bytes;
      for (int corner = 0; corner < 3; ++corner, at += 12)
        corners.push_back({float_at(at), float_at(at + 4), float_at(at + 8)});
    }
    joiner.add(corners, mesh.triangles[begin].data());
    bytes.release(part);
  }
  mesh.vertices = joiner.take_vertices();
  return mesh;
}

// Binary files may begin with the word solid, too. They have bytes of zero, which texts do not have.
bool looks_like_text(std::string_view bytes) {
  std::string_view start = without_byte_order_mark(bytes).substr(0, 512);
  if (start.substr(0, start.find_last_not_of('\0') + 1).find('\0') != std::string_view::npos) return false;
  const std::string_view word = take_word(start);
  return is_keyword(word, "solid");
}

}  // namespace

ReadMesh read_stl(const std::filesystem::path& file, const FileBytes& file_bytes) {
  const std::string_view bytes = file_bytes.view();
  // Where a binary file has its number of triangles, a text has four letters, which promise more than
  // 100,000,000.
  const bool has_header = bytes.size() >= header_bytes;
  const std::uint64_t promised = has_header ? promised_triangles(bytes) : 0;
  const std::uint64_t needed = header_bytes + triangle_bytes * promised;
  if (promised != 0 && needed <= bytes.size()) {
    ReadMesh mesh = read_binary(file_bytes, promised);
    if (needed < bytes.size())
      mesh.contents.entries.push_back(
          {"bytes left out", fmt::format("{}, behind the last triangle", bytes.size() - needed)});
    return mesh;
  }
  if (looks_like_text(bytes)) return TextReader(file, file_bytes).read();
  if (!has_header) {
    raise(Error::bad_format, file, "truncated: a binary .stl file has {} bytes or more, this one {}",
          header_bytes, bytes.size());
  }
  if (needed == bytes.size()) raise(Error::bad_format, file, "has no triangles");
  raise(Error::bad_format, file, "{}: the header promises {} triangles, {} bytes in all, but there are {}",
        needed > bytes.size() ? "truncated" : "too long", promised, needed, bytes.size());
}

}  // namespace workbench
