#include "workbench/formats/ply_header.hpp"

#include "workbench/base/raise.hpp"
#include "workbench/formats/numbers.hpp"
#include "workbench/formats/text.hpp"

namespace workbench {
namespace {

using kerf::Error;

constexpr PlyScalarType scalar_types[] = {
    {{"char", "int8"}, 1, true, true},      {{"uchar", "uint8"}, 1, true, false},
    {{"short", "int16"}, 2, true, true},    {{"ushort", "uint16"}, 2, true, false},
    {{"int", "int32"}, 4, true, true},      {{"uint", "uint32"}, 4, true, false},
    {{"float", "float32"}, 4, false, true}, {{"double", "float64"}, 8, false, true},
    {{"long", "int64"}, 8, true, true},     {{"ulong", "uint64"}, 8, true, false}};

class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& file, std::string_view bytes)
      : file_(file), at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  PlyHeader read() {
    std::string_view rest = next_line();
    if (take_word(rest) != "ply") raise(Error::bad_format, file_, "line 1: does not begin with the word ply");
    // The body of a binary file may begin with the byte of a line's end: the header's lines all end alike.
    const std::string_view line_end = end_of_line_;
    bool has_format = false;
    while (at_ != end_) {
      rest = next_line();
      const std::string_view keyword = take_word(rest);
      if (end_of_line_.empty() && keyword != "end_header") break;  // the last line may be incomplete
      if (keyword == "end_header") {
        if (!has_format) raise(Error::bad_format, file_, "the header names no format");
        const char* const body =
            end_of_line_.starts_with(line_end) ? end_of_line_.data() + line_end.size() : at_;
        header_.body = {body, static_cast<std::size_t>(end_ - body)};
        check_elements();
        return std::move(header_);
      }
      if (keyword == "format") {
        header_.encoding = parse_encoding(take_word(rest));
        has_format = true;
      } else if (keyword == "element") {
        add_element(rest);
      } else if (keyword == "property") {
        add_property(rest);
      } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info" &&
                 !header_.elements.empty()) {
        // Before the elements, such lines are comments that go on.
        raise(Error::bad_format, file_, "line {}: '{}' does not belong in a header", line_, shown(keyword));
      }
    }
    raise(Error::bad_format, file_, "truncated: the header has no end_header");
  }

 private:
  std::string_view next_line() {
    const char* const begin = at_;
    const char* const end = find_line_end(at_, end_);
    at_ = end;
    while (at_ != end_ && *at_ == '\r') ++at_;
    if (at_ != end_ && *at_ == '\n') {
      ++at_;
    } else if (at_ != end) {
      at_ = end + 1;  // lines that end with \r alone, of which some may be blank
    }
    end_of_line_ = {end, static_cast<std::size_t>(at_ - end)};
    ++line_;
    return {begin, static_cast<std::size_t>(end - begin)};
  }

  PlyEncoding parse_encoding(std::string_view word) const {
    if (word == "ascii") return PlyEncoding::ascii;
    if (word == "binary_little_endian") return PlyEncoding::little_endian;
    if (word == "binary_big_endian") return PlyEncoding::big_endian;
    raise(Error::bad_format, file_, "line {}: '{}' is not a format of .ply files", line_, shown(word));
  }

  void add_element(std::string_view rest) {
    const std::string_view name = take_word(rest), count = take_word(rest);
    const Whole number = parse_whole(count.data(), count.data() + count.size());
    if (number.end != count.data() + count.size() || number.value < 0 || number.value > UINT32_MAX ||
        count.empty()) {
      raise(Error::bad_format, file_, "line {}: '{}' cannot be the number of elements", line_, shown(count));
    }
    header_.elements.push_back({name, static_cast<std::uint64_t>(number.value), {}});
  }

  void add_property(std::string_view rest) {
    if (header_.elements.empty()) raise(Error::bad_format, file_, "line {}: a property of no element", line_);
    PlyProperty property;
    std::string_view type = take_word(rest);
    if (type == "list") {
      property.count_type = &scalar_type(take_word(rest));
      if (!property.count_type->is_integer)
        raise(Error::bad_format, file_, "line {}: the length of a list must be an integer", line_);
      type = take_word(rest);
    }
    property.type = &scalar_type(type);
    property.name = take_word(rest);
    header_.elements.back().properties.push_back(property);
  }

  const PlyScalarType& scalar_type(std::string_view name) const {
    for (const PlyScalarType& type : scalar_types) {
      if (type.names[0] == name || type.names[1] == name) return type;
    }
    raise(Error::bad_format, file_, "line {}: '{}' is not a type of .ply files", line_, shown(name));
  }

  void check_elements() const {
    int coordinates[3] = {0, 0, 0}, vertices = 0, lists = 0;
    constexpr std::string_view axes[] = {"x", "y", "z"};
    for (const PlyElement& element : header_.elements) {
      vertices += element.name == "vertex";
      int lists_of_element = 0;
      for (const PlyProperty& property : element.properties) {
        if (element.name == "vertex" && property.count_type == nullptr) {
          for (int axis = 0; axis < 3; ++axis) coordinates[axis] += property.name == axes[axis];
        }
        lists_of_element += is_vertex_list(element, property) || is_strip_list(element, property);
      }
      if (lists_of_element > 1)
        raise(Error::bad_format, file_, "element {} has two lists of vertices", shown(element.name));
      lists += lists_of_element;
    }
    if (vertices > 1) raise(Error::bad_format, file_, "has two elements vertex");
    for (int axis = 0; axis < 3; ++axis) {
      if (coordinates[axis] == 1) continue;
      raise(Error::bad_format, file_, "has no element vertex with one {}", axes[axis]);
    }
    if (lists == 0) {
      raise(Error::bad_format, file_,
            "has no triangles: no element face with a list vertex_indices of integers, and no tristrips");
    }
  }

  const std::filesystem::path& file_;
  const char *at_, *end_;
  std::size_t line_ = 0;
  std::string_view end_of_line_;  ///< of the line last read
  PlyHeader header_;
};

bool is_list_of_vertices(const PlyProperty& property) {
  return (property.name == "vertex_indices" || property.name == "vertex_index") &&
         property.count_type != nullptr && property.type->is_integer;
}

}  // namespace

PlyHeader read_ply_header(const std::filesystem::path& file, std::string_view bytes) {
  return HeaderReader(file, bytes).read();
}

bool is_vertex_list(const PlyElement& element, const PlyProperty& property) {
  return element.name == "face" && is_list_of_vertices(property);
}

bool is_strip_list(const PlyElement& element, const PlyProperty& property) {
  return element.name == "tristrips" && is_list_of_vertices(property);
}

}  // namespace workbench
