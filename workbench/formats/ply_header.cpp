#include "workbench/formats/ply_header.hpp"

#include "workbench/base/raise.hpp"
#include "workbench/formats/text.hpp"

namespace workbench {
namespace {

using kerf::Error;

constexpr PlyScalarType scalar_types[] = {
    {{"char", "int8"}, 1, true, true},      {{"uchar", "uint8"}, 1, true, false},
    {{"short", "int16"}, 2, true, true},    {{"ushort", "uint16"}, 2, true, false},
    {{"int", "int32"}, 4, true, true},      {{"uint", "uint32"}, 4, true, false},
    {{"float", "float32"}, 4, false, true}, {{"double", "float64"}, 8, false, true}};

class HeaderReader {
 public:
  HeaderReader(const std::filesystem::path& file, std::string_view bytes) : file_(file), lines_(bytes) {}

  PlyHeader read() {
    if (lines_.next() != "ply") raise(Error::bad_format, file_, "line 1: does not begin with the word ply");
    bool has_format = false;
    while (const auto line = lines_.next()) {
      std::string_view rest = *line;
      const std::string_view keyword = take_word(rest);
      if (lines_.rest().empty() && keyword != "end_header") break;  // the last line may be incomplete
      if (keyword == "end_header") {
        if (!has_format) raise(Error::bad_format, file_, "the header names no format");
        header_.lines = lines_.number();
        header_.body = lines_.rest();
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
      } else if (keyword != "comment" && keyword != "obj_info") {
        raise(Error::bad_format, file_, "line {}: '{}' does not belong in a header", lines_.number(),
              keyword);
      }
    }
    raise(Error::bad_format, file_, "truncated: the header has no end_header");
  }

 private:
  PlyEncoding parse_encoding(std::string_view word) const {
    if (word == "ascii") return PlyEncoding::ascii;
    if (word == "binary_little_endian") return PlyEncoding::little_endian;
    if (word == "binary_big_endian") return PlyEncoding::big_endian;
    raise(Error::bad_format, file_, "line {}: '{}' is not a format of .ply files", lines_.number(), word);
  }

  void add_element(std::string_view rest) {
    const std::string_view name = take_word(rest), count = take_word(rest);
    const auto number = to_number<std::uint64_t>(count);
    if (!number || *number > UINT32_MAX) {
      raise(Error::bad_format, file_, "line {}: '{}' cannot be the number of elements", lines_.number(),
            count);
    }
    header_.elements.push_back({name, *number, {}});
  }

  void add_property(std::string_view rest) {
    if (header_.elements.empty())
      raise(Error::bad_format, file_, "line {}: a property of no element", lines_.number());
    PlyProperty property;
    std::string_view type = take_word(rest);
    if (type == "list") {
      property.count_type = &scalar_type(take_word(rest));
      if (!property.count_type->is_integer) {
        raise(Error::bad_format, file_, "line {}: the length of a list must be an integer", lines_.number());
      }
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
    raise(Error::bad_format, file_, "line {}: '{}' is not a type of .ply files", lines_.number(), name);
  }

  void check_elements() const {
    int coordinates = 0, vertices = 0, lists = 0;
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty())
        raise(Error::bad_format, file_, "element {} has no properties", element.name);
      vertices += element.name == "vertex";
      for (const PlyProperty& property : element.properties) {
        const bool is_coordinate = property.name == "x" || property.name == "y" || property.name == "z";
        coordinates += element.name == "vertex" && is_coordinate && property.count_type == nullptr;
        if (!is_vertex_list(element, property)) continue;
        ++lists;
        if (vertices == 0)
          raise(Error::bad_format, file_, "the faces come before the vertices that they name");
      }
    }
    if (vertices != 1 || coordinates != 3)
      raise(Error::bad_format, file_, "has no element vertex with x, y and z, or has two");
    if (lists != 1)
      raise(Error::bad_format, file_,
            "has no triangles: no element face with one list vertex_indices of integers");
  }

  const std::filesystem::path& file_;
  Lines lines_;
  PlyHeader header_;
};

}  // namespace

PlyHeader read_ply_header(const std::filesystem::path& file, std::string_view bytes) {
  return HeaderReader(file, bytes).read();
}

bool is_vertex_list(const PlyElement& element, const PlyProperty& property) {
  return element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index") &&
         property.count_type != nullptr && property.type->is_integer;
}

}  // namespace workbench
