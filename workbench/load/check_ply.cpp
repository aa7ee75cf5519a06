#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include <fmt/format.h>
#include <kerf/error.hpp>

#include "workbench/load/checks.hpp"
#include "workbench/load/text.hpp"

namespace workbench {
namespace {

using kerf::Error;

struct ScalarType {
  std::array<std::string_view, 2> names;
  std::size_t bytes;
  bool is_integer;
};
constexpr ScalarType scalar_types[] = {{{"char", "int8"}, 1, true},      {{"uchar", "uint8"}, 1, true},
                                       {{"short", "int16"}, 2, true},    {{"ushort", "uint16"}, 2, true},
                                       {{"int", "int32"}, 4, true},      {{"uint", "uint32"}, 4, true},
                                       {{"float", "float32"}, 4, false}, {{"double", "float64"}, 8, false}};

struct Property {
  std::string_view name;
  const ScalarType* type = nullptr;
  const ScalarType* count_type = nullptr;  ///< of a list; null for a scalar
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding { ascii, little_endian, big_endian };

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::size_t lines = 0;
  std::string_view body;
};

class PlyCheck {
 public:
  PlyCheck(const std::filesystem::path& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

  void run() {
    const Header header = read_header();
    for (const Element& element : header.elements) {
      if (element.name == "vertex") vertices_ = element.count;
    }
    if (header.encoding == Encoding::ascii) {
      check_text(header);
    } else {
      check_binary(header);
    }
  }

 private:
  template <class... Arguments>
  [[noreturn]] void fail(Error::Code code, fmt::format_string<Arguments...> text,
                         Arguments&&... arguments) const {
    throw Error(code, fmt::format("{}: {}", file_.string(),
                                  fmt::format(text, std::forward<Arguments>(arguments)...)));
  }

  const ScalarType& scalar_type(std::string_view name, std::size_t line) const {
    for (const ScalarType& type : scalar_types) {
      if (type.names[0] == name || type.names[1] == name) return type;
    }
    fail(Error::bad_format, "line {}: '{}' is not a type of a property", line, name);
  }

  Header read_header() const {
    Header header;
    Lines lines(bytes_);
    if (lines.next() != "ply") fail(Error::bad_format, "line 1: does not begin with the word ply");
    bool has_format = false;
    for (auto line = lines.next(); line; line = lines.next()) {
      std::string_view rest = *line;
      const std::string_view keyword = take_word(rest);
      if (keyword == "end_header") {
        header.lines = lines.number();
        header.body = lines.rest();
        if (!has_format) fail(Error::bad_format, "the header names no format");
        check_header(header);
        return header;
      }
      if (keyword == "format") {
        has_format = true;
        header.encoding = read_encoding(take_word(rest), lines.number());
      } else if (keyword == "element") {
        const std::string_view name = take_word(rest), count = take_word(rest);
        const auto number = to_number<std::uint64_t>(count);
        if (!number || *number > UINT32_MAX) {
          fail(Error::bad_format, "line {}: '{}' cannot be the number of elements", lines.number(), count);
        }
        header.elements.push_back({name, *number, {}});
      } else if (keyword == "property") {
        if (header.elements.empty())
          fail(Error::bad_format, "line {}: a property of no element", lines.number());
        header.elements.back().properties.push_back(read_property(rest, lines.number()));
      }  // anything else is a comment
    }
    fail(Error::bad_format, "truncated: the header has no end_header");
  }

  Encoding read_encoding(std::string_view word, std::size_t line) const {
    if (word == "ascii") return Encoding::ascii;
    if (word == "binary_little_endian") return Encoding::little_endian;
    if (word == "binary_big_endian") return Encoding::big_endian;
    fail(Error::bad_format, "line {}: '{}' is not a format of .ply files", line, word);
  }

  Property read_property(std::string_view rest, std::size_t line) const {
    const std::string_view first = take_word(rest);
    Property property;
    if (first == "list") {
      property.count_type = &scalar_type(take_word(rest), line);
      if (!property.count_type->is_integer)
        fail(Error::bad_format, "line {}: the count of a list must be an integer", line);
      property.type = &scalar_type(take_word(rest), line);
    } else {
      property.type = &scalar_type(first, line);
    }
    property.name = take_word(rest);
    return property;
  }

  static bool is_vertex_list(const Element& element, const Property& property) {
    return element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index");
  }

  void check_header(const Header& header) const {
    const auto is_scalar = [](const Element& element, std::string_view name) {
      return std::any_of(element.properties.begin(), element.properties.end(),
                         [&](const Property& p) { return p.name == name && p.count_type == nullptr; });
    };
    bool has_vertices = false, has_faces = false;
    for (const Element& element : header.elements) {
      if (element.properties.empty()) fail(Error::bad_format, "element {} has no properties", element.name);
      if (element.name == "vertex") {
        has_vertices = is_scalar(element, "x") && is_scalar(element, "y") && is_scalar(element, "z");
      }
      for (const Property& property : element.properties) {
        if (!is_vertex_list(element, property)) continue;
        has_faces = property.count_type != nullptr && property.type->is_integer;
      }
    }
    if (!has_vertices) fail(Error::bad_format, "has no vertices with x, y and z");
    if (!has_faces) fail(Error::bad_format, "has no triangles: no element face with a list vertex_indices");
  }

  void check_index(std::int64_t index, std::uint64_t face) const {
    if (index < 0 || static_cast<std::uint64_t>(index) >= vertices_) {
      fail(Error::index_out_of_range, "face {} names vertex {}, but there are {}", face, index, vertices_);
    }
  }

  // Every element stands on a line of its own.
  void check_text(const Header& header) const {
    Lines lines(header.body);
    for (const Element& element : header.elements) {
      for (std::uint64_t i = 0; i < element.count; ++i) {
        const auto line = lines.next();
        if (!line)
          fail(Error::bad_format, "truncated: ends before {} {} of {}", element.name, i, element.count);
        std::string_view rest = *line;
        for (const Property& property : element.properties) {
          check_text_property(rest, element, property, i, header.lines + lines.number());
        }
      }
    }
  }

  void check_text_property(std::string_view& rest, const Element& element, const Property& property,
                           std::uint64_t i, std::size_t line) const {
    std::int64_t count = 1;
    const auto take = [&](auto zero) {
      const std::string_view word = take_word(rest);
      if (word.empty())
        fail(Error::bad_format, "truncated: line {}: {} {} ends before its {}", line, element.name, i,
             property.name);
      const auto number = to_number<decltype(zero)>(word);
      if (!number)
        fail(Error::bad_format, "line {}: {} {}: '{}' cannot be its {}", line, element.name, i, word,
             property.name);
      return *number;
    };
    if (property.count_type != nullptr) {
      count = take(std::int64_t{});
      if (count < 0) fail(Error::bad_format, "line {}: {} {} has a list of {}", line, element.name, i, count);
    }
    for (std::int64_t k = 0; k < count; ++k) {
      if (!property.type->is_integer) {
        take(double{});
      } else if (const std::int64_t value = take(std::int64_t{}); is_vertex_list(element, property)) {
        check_index(value, i);
      }
    }
  }

  static std::int64_t integer_at(const char* bytes, const ScalarType& type, Encoding encoding) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < type.bytes; ++i) {
      const std::size_t from = encoding == Encoding::little_endian ? type.bytes - 1 - i : i;
      value = value << 8 | static_cast<unsigned char>(bytes[from]);
    }
    const std::size_t unused = 64 - 8 * type.bytes;
    const bool is_signed = type.names[0][0] != 'u';
    return is_signed ? static_cast<std::int64_t>(value << unused) >> unused
                     : static_cast<std::int64_t>(value);
  }

  void check_binary(const Header& header) const {
    std::string_view rest = header.body;
    for (const Element& element : header.elements) {
      for (std::uint64_t i = 0; i < element.count; ++i) {
        for (const Property& property : element.properties) {
          const auto take = [&](std::size_t size) {
            if (size > rest.size()) {
              fail(Error::bad_format, "truncated: ends at byte {}, within {} {} of {}", bytes_.size(),
                   element.name, i, element.count);
            }
            const char* begin = rest.data();
            rest.remove_prefix(size);
            return begin;
          };
          std::uint64_t count = 1;
          if (property.count_type != nullptr) {
            const std::int64_t length =
                integer_at(take(property.count_type->bytes), *property.count_type, header.encoding);
            if (length < 0) fail(Error::bad_format, "{} {} has a list of {}", element.name, i, length);
            count = static_cast<std::uint64_t>(length);
          }
          const char* values = take(count * property.type->bytes);
          if (!is_vertex_list(element, property)) continue;
          for (std::uint64_t k = 0; k < count; ++k) {
            check_index(integer_at(values + k * property.type->bytes, *property.type, header.encoding), i);
          }
        }
      }
    }
  }

  const std::filesystem::path& file_;
  std::string_view bytes_;
  std::uint64_t vertices_ = 0;
};

}  // namespace

void check_ply(const std::filesystem::path& file, std::string_view bytes) {
  PlyCheck(file, bytes).run();
}

}  // namespace workbench
