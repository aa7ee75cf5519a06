#include <bit>
#include <cmath>
#include <cstdint>

#include "workbench/base/raise.hpp"
#include "workbench/formats/checks.hpp"
#include "workbench/formats/text.hpp"

namespace workbench {
namespace {

using kerf::Error;

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

std::uint32_t promised_triangles(std::string_view bytes) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    count |= std::uint32_t{static_cast<unsigned char>(bytes[80 + i])} << 8 * i;
  }
  return count;
}

// Reads the grammar of text files word for word.
class TextReader {
 public:
  TextReader(const std::filesystem::path& file, std::string_view bytes) : file_(file), lines_(bytes) {}

  std::string to_binary() {
    std::string triangles;
    std::uint32_t count = 0;
    while (next_statement()) {
      expect("solid");
      for (need_statement(); keyword_ != "endsolid"; need_statement(), ++count) {
        expect("facet");
        need_statement();
        expect("outer");
        triangles.append(3 * sizeof(float), '\0');  // the normal, which is not used
        for (int i = 0; i < 3; ++i) append_vertex(triangles);
        triangles.append(2, '\0');
        need_statement();
        expect("endloop");
        need_statement();
        expect("endfacet");
        ++facet_;
      }
    }
    std::string bytes(header_bytes - 4, '\0');
    append(bytes, count);
    return bytes + triangles;
  }

 private:
  // Moves on to the next line that is not blank: its first word, and what follows it.
  bool next_statement() {
    do {
      const auto line = lines_.next();
      if (!line) return false;
      rest_ = *line;
      keyword_ = take_word(rest_);
    } while (keyword_.empty());
    return true;
  }
  void need_statement() {
    if (!next_statement()) {
      raise(Error::bad_format, file_, "truncated: ends at line {}, after {} facets, without endsolid",
            lines_.number(), facet_);
    }
  }
  void expect(std::string_view keyword) const {
    if (keyword_ == keyword) return;
    raise(Error::bad_format, file_, "line {}: facet {}: '{}' stands where {} should", lines_.number(), facet_,
          keyword_, keyword);
  }

  void append_vertex(std::string& bytes) {
    need_statement();
    expect("vertex");
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = take_word(rest_);
      const auto value = to_number<double>(word);
      if (word.empty())
        raise(Error::bad_format, file_, "line {}: a vertex of facet {} ends early", lines_.number(), facet_);
      if (!value)
        raise(Error::bad_format, file_, "line {}: facet {}: '{}' is not a number", lines_.number(), facet_,
              word);
      const auto coordinate = static_cast<float>(*value);
      if (!std::isfinite(coordinate)) {
        raise(Error::non_finite_vertex, file_, "line {}: a vertex of facet {} is not finite: {}",
              lines_.number(), facet_, word);
      }
      append(bytes, std::bit_cast<std::uint32_t>(coordinate));
    }
  }

  static void append(std::string& bytes, std::uint32_t value) {
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(value >> 8 * i & 0xff));
  }

  const std::filesystem::path& file_;
  Lines lines_;
  std::string_view keyword_, rest_;
  std::uint32_t facet_ = 0;
};

std::string to_binary(const std::filesystem::path& file, std::string_view bytes) {
  // Binary files may begin with the word solid, too. Their length distinguishes them.
  const bool has_header = bytes.size() >= header_bytes;
  if (has_header && bytes.size() == header_bytes + triangle_bytes * promised_triangles(bytes)) {
    return std::string(header_bytes - 4, '\0').append(bytes.substr(header_bytes - 4));
  }
  std::string_view start = bytes.substr(0, 256);
  if (take_word(start) == "solid") return TextReader(file, bytes).to_binary();
  if (!has_header) {
    raise(Error::bad_format, file, "truncated: a binary .stl file has {} bytes or more, this one {}",
          header_bytes, bytes.size());
  }
  const std::uint64_t promised = promised_triangles(bytes);
  const std::uint64_t needed = header_bytes + triangle_bytes * promised;
  raise(Error::bad_format, file, "{}: the header promises {} triangles, {} bytes in all, but there are {}",
        needed > bytes.size() ? "truncated" : "too long", promised, needed, bytes.size());
}

}  // namespace

std::string plain_stl(const std::filesystem::path& file, std::string_view bytes) {
  std::string plain = to_binary(file, bytes);
  if (plain.size() == header_bytes) {
    raise(Error::bad_format, file, "has no triangles");
  }
  return plain;
}

}  // namespace workbench
