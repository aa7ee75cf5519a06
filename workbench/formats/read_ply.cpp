#include "workbench/formats/read_ply.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "workbench/base/raise.hpp"
#include "workbench/formats/faces.hpp"
#include "workbench/formats/large_vector.hpp"
#include "workbench/formats/numbers.hpp"
#include "workbench/formats/ply_header.hpp"
#include "workbench/formats/text.hpp"

namespace workbench {
namespace {

using kerf::Error;
using kerf::Vec3f;

/// Bytes of the file after which the system is told that they are done with.
constexpr std::size_t release_bytes = std::size_t{1} << 22;

// The element that is being read, for the sentences of errors.
struct Place {
  const std::filesystem::path& file;
  const PlyElement& element;
  std::uint64_t number;  ///< of the element
};

// The body of a text file: words, however they stand on lines.
class TextSource {
 public:
  TextSource(std::string_view file_bytes, std::string_view body)
      : bytes_(file_bytes), at_(body.data()), end_(at_ + body.size()) {}

  const char* at() const { return at_; }

  /// At least so many bytes stand for an element of a property or more: a word and a blank.
  static std::uint64_t min_bytes(const PlyElement& element) { return 2 * element.properties.size(); }
  std::uint64_t bytes_left() const {
    return static_cast<std::uint64_t>(end_ - at_) + 1;
  }  // the last word needs no blank
  void check_end(const Place&) const {}

  void skip(const Place& place, const PlyProperty& property) {
    at_ = skip_word(begin_word(place, property), end_);
  }

  Real take_real(const Place& place, const PlyProperty& property) {
    const char* const word = begin_word(place, property);
    const Real real = parse_real(word, end_);
    if (real.end == nullptr || !(real.end == end_ || is_space(*real.end))) raise_word(place, property, word);
    at_ = real.end;
    return real;
  }

  std::int64_t take_integer(const Place& place, const PlyProperty& property, const PlyScalarType&) {
    const char* const word = begin_word(place, property);
    const Whole whole = parse_whole(word, end_);
    if (whole.end != nullptr && (whole.end == end_ || is_space(*whole.end))) {
      at_ = whole.end;
      return whole.value;
    }
    // Some programs write all numbers alike: 3.0 is a whole number as well.
    const Real real = take_real(place, property);
    constexpr double limit = 0x1p53;
    if (!(std::abs(real.wide) < limit) || std::floor(real.wide) != real.wide)
      raise_word(place, property, word);
    return static_cast<std::int64_t>(real.wide);
  }

  std::string where() const { return fmt::format("line {}: ", line_number(bytes_, at_)); }

 private:
  const char* begin_word(const Place& place, const PlyProperty& property) {
    at_ = skip_spaces(at_, end_);
    if (at_ != end_) return at_;
    raise(Error::bad_format, place.file, "truncated: line {}: {} {} of {} ends before its {}",
          last_line_number(bytes_), shown(place.element.name), place.number, place.element.count,
          shown(property.name));
  }

  [[noreturn]] void raise_word(const Place& place, const PlyProperty& property, const char* word) const {
    const auto length = static_cast<std::size_t>(skip_word(word, end_) - word);
    raise(Error::bad_format, place.file, "line {}: {} {}: '{}' cannot be its {}", line_number(bytes_, word),
          shown(place.element.name), place.number, shown({word, length}), shown(property.name));
  }

  std::string_view bytes_;
  const char *at_, *end_;
};

// The body of a binary file: values, one behind another.
template <bool swaps>
class BinarySource {
 public:
  BinarySource(std::string_view file_bytes, std::string_view body)
      : file_size_(file_bytes.size()), at_(body.data()), end_(at_ + body.size()) {}

  const char* at() const { return at_; }

  static std::uint64_t min_bytes(const PlyElement& element) {
    std::uint64_t bytes = 0;
    for (const PlyProperty& property : element.properties)
      bytes += property.count_type != nullptr ? property.count_type->bytes : property.type->bytes;
    return bytes;
  }
  std::uint64_t bytes_left() const { return static_cast<std::uint64_t>(end_ - at_); }

  void skip(const Place& place, const PlyProperty& property) { take(place, property.type->bytes); }

  Real take_real(const Place& place, const PlyProperty& property) {
    const PlyScalarType& type = *property.type;
    Real real;
    if (type.is_integer) {
      real.wide = static_cast<double>(take_integer(place, property, type));
      real.nearest = static_cast<float>(real.wide);
    } else if (type.bytes == sizeof(float)) {
      real.nearest = value<float>(take(place, sizeof(float)));
      real.wide = real.nearest;
    } else {
      real.wide = value<double>(take(place, sizeof(double)));
      real.nearest = static_cast<float>(real.wide);
    }
    return real;
  }

  std::int64_t take_integer(const Place& place, const PlyProperty&, const PlyScalarType& type) {
    const char* const bytes = take(place, type.bytes);
    switch (type.bytes) {
      case 1:
        return type.is_signed ? std::int64_t{value<std::int8_t>(bytes)} : value<std::uint8_t>(bytes);
      case 2:
        return type.is_signed ? std::int64_t{value<std::int16_t>(bytes)} : value<std::uint16_t>(bytes);
      case 4:
        return type.is_signed ? std::int64_t{value<std::int32_t>(bytes)} : value<std::uint32_t>(bytes);
      default: {
        const auto whole = value<std::int64_t>(bytes);
        return type.is_signed || whole >= 0 ? whole : std::numeric_limits<std::int64_t>::max();
      }
    }
  }

  std::string where() const { return ""; }

  /// The next `count` values of `bytes` each, or null if there are fewer.
  const char* take_block(std::uint64_t count, std::size_t bytes) {
    if (count > bytes_left() / bytes) return nullptr;
    const char* const block = at_;
    at_ += count * bytes;
    return block;
  }

  template <class Number>
  static Number value(const char* from) {
    char bytes[sizeof(Number)];
    std::memcpy(bytes, from, sizeof(Number));
    if constexpr (swaps) std::reverse(bytes, bytes + sizeof(Number));
    return std::bit_cast<Number>(bytes);
  }

 private:
  const char* take(const Place& place, std::size_t count) {
    if (bytes_left() < count) {
      raise(Error::bad_format, place.file, "truncated: ends at byte {}, within {} {} of {}", file_size_,
            shown(place.element.name), place.number, place.element.count);
    }
    const char* const taken = at_;
    at_ += count;
    return taken;
  }

  std::size_t file_size_;
  const char *at_, *end_;
};

template <class Source>
class BodyReader {
 public:
  BodyReader(const std::filesystem::path& file, const FileBytes& bytes, const PlyHeader& header)
      : file_(file),
        bytes_(bytes),
        header_(header),
        source_(bytes.view(), header.body),
        released_(header.body.data()) {
    for (const PlyElement& element : header.elements) {
      if (element.name == "vertex") vertex_count_ = element.count;
    }
  }

  ReadMesh read() {
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      check_room(element);
      if (element.name == "vertex") {
        read_vertices(element);
      } else {
        read_others(element);
      }
    }
    std::size_t crossing = 0;
    const std::size_t small_faces = faces_.without_surface();
    mesh_.triangles = faces_.take_triangles(mesh_.vertices, crossing);
    const auto tell = [&](std::size_t count, const char* name, const char* what) {
      if (count != 0) mesh_.contents.entries.push_back({name, fmt::format("{}{}", count, what)});
    };
    tell(strips_, "strips", " elements, as triangles");
    tell(small_faces, "faces left out", ", of fewer than three corners");
    tell(crossing, "crossing polygons", ", whose outlines cross themselves: covered somehow");
    for (const PlyElement& element : header_.elements) {
      const bool is_read =
          std::any_of(element.properties.begin(), element.properties.end(), [&](const PlyProperty& property) {
            return element.name == "vertex" || is_vertex_list(element, property) ||
                   is_strip_list(element, property);
          });
      if (!is_read && element.count != 0)
        mesh_.contents.entries.push_back(
            {"elements left out", fmt::format("{} {}", element.count, shown(element.name))});
    }
    return std::move(mesh_);
  }

 private:
  // No memory is taken for elements that the file is too short for.
  void check_room(const PlyElement& element) const {
    if (element.count <= source_.bytes_left() / std::max<std::uint64_t>(1, Source::min_bytes(element)))
      return;
    raise(Error::bad_format, file_, "truncated: {}{} elements {} cannot be in the {} bytes that are left",
          source_.where(), element.count, shown(element.name), source_.bytes_left());
  }

  void release() {
    if (source_.at() - released_ < static_cast<std::ptrdiff_t>(release_bytes)) return;
    bytes_.release({released_, static_cast<std::size_t>(source_.at() - released_)});
    released_ = source_.at();
  }

  void read_vertices(const PlyElement& element) {
    reserve_large(mesh_.vertices, element.count);
    if (read_plain_vertices(element)) return;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      const Place place{file_, element, i};
      Real values[3];
      for (const PlyProperty& property : element.properties) {
        if (property.count_type != nullptr) {
          skip_list(place, property);
        } else if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z') {
          values[property.name[0] - 'x'] = source_.take_real(place, property);
        } else {
          source_.skip(place, property);
        }
      }
      const Vec3f nearest{values[0].nearest, values[1].nearest, values[2].nearest};
      mesh_.add_vertex(nearest, {values[0].remainder(), values[1].remainder(), values[2].remainder()});
      release();
    }
  }

  // Vertices of nothing but scalars, of which x, y and z are floats: the most frequent kind.
  bool read_plain_vertices(const PlyElement& element) {
    if constexpr (!std::is_same_v<Source, TextSource>) {
      std::size_t offsets[3] = {}, stride = 0;
      for (const PlyProperty& property : element.properties) {
        if (property.count_type != nullptr) return false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          if (property.name != std::string_view("xyz").substr(axis, 1)) continue;
          if (property.type->is_integer || property.type->bytes != sizeof(float)) return false;
          offsets[axis] = stride;
        }
        stride += property.type->bytes;
      }
      for (std::uint64_t left = element.count; left != 0;) {
        const std::uint64_t count = std::min<std::uint64_t>(left, release_bytes / stride + 1);
        const char* vertex = source_.take_block(count, stride);
        for (std::uint64_t i = 0; i < count; ++i, vertex += stride) {
          mesh_.vertices.push_back({Source::template value<float>(vertex + offsets[0]),
                                    Source::template value<float>(vertex + offsets[1]),
                                    Source::template value<float>(vertex + offsets[2])});
        }
        left -= count;
        release();
      }
      return true;
    }
    return false;
  }

  void read_others(const PlyElement& element) {
    bool has_faces = false;
    for (const PlyProperty& property : element.properties)
      has_faces = has_faces || is_vertex_list(element, property);
    if (has_faces) faces_.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      const Place place{file_, element, i};
      for (const PlyProperty& property : element.properties) {
        if (is_vertex_list(element, property)) {
          read_face(place, property);
        } else if (is_strip_list(element, property)) {
          read_strips(place, property);
        } else if (property.count_type != nullptr) {
          skip_list(place, property);
        } else {
          source_.skip(place, property);
        }
      }
      release();
    }
  }

  void skip_list(const Place& place, const PlyProperty& property) {
    for (std::int64_t left = read_length(place, property); left > 0; --left) source_.skip(place, property);
  }

  std::int64_t read_length(const Place& place, const PlyProperty& property) {
    const std::int64_t length = source_.take_integer(place, property, *property.count_type);
    if (length < 0)
      raise(Error::bad_format, file_, "{}{} {} has a list of {}", source_.where(), shown(place.element.name),
            place.number, length);
    return length;
  }

  std::uint32_t read_corner(const Place& place, const PlyProperty& property) {
    return checked(place, source_.take_integer(place, property, *property.type));
  }
  std::uint32_t checked(const Place& place, std::int64_t index) const {
    if (static_cast<std::uint64_t>(index) >= vertex_count_) {
      raise(Error::index_out_of_range, file_, "{}{} {} names vertex {}, but there are {}", source_.where(),
            place.element.name, place.number, index, vertex_count_);
    }
    return static_cast<std::uint32_t>(index);
  }

  void read_face(const Place& place, const PlyProperty& property) {
    const std::int64_t length = read_length(place, property);
    if (length == 3) {
      const std::uint32_t a = read_corner(place, property), b = read_corner(place, property),
                          c = read_corner(place, property);
      faces_.add({a, b, c});
      return;
    }
    corners_.clear();
    for (std::int64_t i = 0; i < length; ++i) corners_.push_back(read_corner(place, property));
    faces_.add(std::span<const std::uint32_t>(corners_));
  }

  // Every second triangle of a strip goes round the other way.
  void read_strips(const Place& place, const PlyProperty& property) {
    const std::int64_t length = read_length(place, property);
    std::uint32_t before[2] = {};
    std::size_t corners = 0;  // of the strip so far
    for (std::int64_t i = 0; i < length; ++i) {
      const std::int64_t index = source_.take_integer(place, property, *property.type);
      if (index == -1) {
        corners = 0;
        continue;
      }
      const std::uint32_t corner = checked(place, index);
      if (corners >= 2) {
        const bool turns = corners % 2 != 0;
        faces_.add({before[turns], before[!turns], corner});
      }
      before[0] = before[1];
      before[1] = corner;
      ++corners;
    }
    ++strips_;
  }

  const std::filesystem::path& file_;
  const FileBytes& bytes_;
  const PlyHeader& header_;
  Source source_;
  const char* released_;
  std::uint64_t vertex_count_ = 0;
  ReadMesh mesh_;
  Faces faces_;
  std::size_t strips_ = 0;
  std::vector<std::uint32_t> corners_;  ///< of one face
};

}  // namespace

ReadMesh read_ply(const std::filesystem::path& file, const FileBytes& bytes) {
  const PlyHeader header = read_ply_header(file, without_byte_order_mark(bytes.view()));
  if (header.encoding == PlyEncoding::ascii) return BodyReader<TextSource>(file, bytes, header).read();
  constexpr bool is_little = std::endian::native == std::endian::little;
  if ((header.encoding == PlyEncoding::little_endian) == is_little)
    return BodyReader<BinarySource<false>>(file, bytes, header).read();
  return BodyReader<BinarySource<true>>(file, bytes, header).read();
}

}  // namespace workbench
