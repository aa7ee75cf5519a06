#include "workbench/formats/read_ply.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "workbench/base/raise.hpp"
#include "workbench/formats/ply_header.hpp"
#include "workbench/formats/text.hpp"
#include "workbench/formats/triangulate.hpp"

namespace workbench {
namespace {

using kerf::Error;

// The element that is being read, for the sentences of errors.
struct Place {
  const std::filesystem::path& file;
  const PlyElement& element;
  std::uint64_t number;  ///< of the element
};

// The elements of a text file, each on a line of its own.
class TextSource {
 public:
  explicit TextSource(const PlyHeader& header) : lines_(header.body), header_lines_(header.lines) {}

  void begin_element(const Place& place) {
    const auto line = lines_.next();
    if (!line) {
      raise(Error::bad_format, place.file, "truncated: ends before {} {} of {}", place.element.name,
            place.number, place.element.count);
    }
    rest_ = *line;
  }

  double take_real(const Place& place, const PlyProperty& property, const PlyScalarType&) {
    return take<double>(place, property);
  }
  std::int64_t take_integer(const Place& place, const PlyProperty& property, const PlyScalarType&) {
    return take<std::int64_t>(place, property);
  }

 private:
  template <class Number>
  Number take(const Place& place, const PlyProperty& property) {
    const std::string_view word = take_word(rest_);
    const auto number = to_number<Number>(word);
    if (!number) {
      const std::size_t line = header_lines_ + lines_.number();
      if (word.empty()) {
        raise(Error::bad_format, place.file, "truncated: line {}: {} {} ends before its {}", line,
              place.element.name, place.number, property.name);
      }
      raise(Error::bad_format, place.file, "line {}: {} {}: '{}' cannot be its {}", line, place.element.name,
            place.number, word, property.name);
    }
    return *number;
  }

  Lines lines_;
  std::size_t header_lines_;
  std::string_view rest_;
};

// The elements of a binary file, one after another.
class BinarySource {
 public:
  BinarySource(const PlyHeader& header, std::size_t file_size)
      : rest_(header.body), file_size_(file_size), swaps_(is_swapped(header.encoding)) {}

  void begin_element(const Place&) {}

  double take_real(const Place& place, const PlyProperty&, const PlyScalarType& type) {
    return type.bytes == sizeof(float) ? double{take<float>(place)} : take<double>(place);
  }

  std::int64_t take_integer(const Place& place, const PlyProperty&, const PlyScalarType& type) {
    switch (type.bytes) {
      case 1:
        return type.is_signed ? std::int64_t{take<std::int8_t>(place)} : take<std::uint8_t>(place);
      case 2:
        return type.is_signed ? std::int64_t{take<std::int16_t>(place)} : take<std::uint16_t>(place);
      default:
        return type.is_signed ? std::int64_t{take<std::int32_t>(place)} : take<std::uint32_t>(place);
    }
  }

 private:
  static bool is_swapped(PlyEncoding encoding) {
    return (encoding == PlyEncoding::little_endian) != (std::endian::native == std::endian::little);
  }

  template <class Number>
  Number take(const Place& place) {
    if (rest_.size() < sizeof(Number)) {
      raise(Error::bad_format, place.file, "truncated: ends at byte {}, within {} {} of {}", file_size_,
            place.element.name, place.number, place.element.count);
    }
    char bytes[sizeof(Number)];
    std::memcpy(bytes, rest_.data(), sizeof(Number));
    if (swaps_) std::reverse(bytes, bytes + sizeof(Number));
    rest_.remove_prefix(sizeof(Number));
    return std::bit_cast<Number>(bytes);
  }

  std::string_view rest_;
  std::size_t file_size_;
  bool swaps_;
};

template <class Source>
class BodyReader {
 public:
  BodyReader(const std::filesystem::path& file, const PlyHeader& header, Source source)
      : file_(file), header_(header), source_(source) {
    for (const PlyElement& element : header.elements) {
      if (element.name == "vertex") vertex_count_ = element.count;
    }
  }

  Scene read() {
    for (const PlyElement& element : header_.elements) {
      for (std::uint64_t i = 0; i < element.count; ++i) read_element({file_, element, i});
    }
    return std::move(scene_);
  }

 private:
  void read_element(const Place& place) {
    source_.begin_element(place);
    const bool is_vertex = place.element.name == "vertex";
    kerf::Vec3f vertex;
    for (const PlyProperty& property : place.element.properties) {
      if (is_vertex_list(place.element, property)) {
        read_face(place, property);
      } else if (property.count_type != nullptr) {
        for (std::int64_t left = read_length(place, property); left > 0; --left) read_number(place, property);
      } else {
        const auto value = static_cast<float>(read_number(place, property));
        if (property.name == "x") vertex.x = value;
        if (property.name == "y") vertex.y = value;
        if (property.name == "z") vertex.z = value;
      }
    }
    if (is_vertex) scene_.vertices.push_back(vertex);
  }

  double read_number(const Place& place, const PlyProperty& property) {
    const PlyScalarType& type = *property.type;
    return type.is_integer ? static_cast<double>(source_.take_integer(place, property, type))
                           : source_.take_real(place, property, type);
  }

  std::int64_t read_length(const Place& place, const PlyProperty& property) {
    const std::int64_t length = source_.take_integer(place, property, *property.count_type);
    if (length < 0)
      raise(Error::bad_format, place.file, "{} {} has a list of {}", place.element.name, place.number,
            length);
    return length;
  }

  void read_face(const Place& place, const PlyProperty& property) {
    const std::int64_t length = read_length(place, property);
    corners_.clear();
    for (std::int64_t i = 0; i < length; ++i) {
      const std::int64_t index = source_.take_integer(place, property, *property.type);
      if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count_) {
        raise(Error::index_out_of_range, place.file, "face {} names vertex {}, but there are {}",
              place.number, index, vertex_count_);
      }
      corners_.push_back(static_cast<std::uint32_t>(index));
    }
    if (length == 3) {
      scene_.triangles.push_back({corners_[0], corners_[1], corners_[2]});
    } else if (length > 3) {
      append_polygon(scene_, corners_);
    }
  }

  const std::filesystem::path& file_;
  const PlyHeader& header_;
  Source source_;
  std::uint64_t vertex_count_ = 0;
  Scene scene_;
  std::vector<std::uint32_t> corners_;  ///< of one face
};

}  // namespace

Scene read_ply(const std::filesystem::path& file, std::string_view bytes) {
  const PlyHeader header = read_ply_header(file, bytes);
  if (header.encoding == PlyEncoding::ascii) return BodyReader(file, header, TextSource(header)).read();
  return BodyReader(file, header, BinarySource(header, bytes.size())).read();
}

}  // namespace workbench
