// Blanks, words and lines of text files. A line ends with `\n`, `\r\n` or `\r`.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace workbench {

// Whether `characters`, none of which is behind the blank, has a bit for `c`: most characters of a file are
// behind it.
inline bool is_among(std::uint64_t characters, char c) {
  const auto code = static_cast<unsigned char>(c);
  return code <= ' ' && ((characters >> code) & 1) != 0;
}
constexpr std::uint64_t bits_of(std::string_view characters) {
  std::uint64_t bits = 0;
  for (const char c : characters) bits |= std::uint64_t{1} << static_cast<unsigned char>(c);
  return bits;
}

inline constexpr std::uint64_t line_ends = bits_of("\n\r");
/// Blanks do not end a line. A file may end with bytes of zero.
inline constexpr std::uint64_t blanks = bits_of({" \t\v\f\0", 5});

inline bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}
inline bool is_blank(char c) {
  return is_among(blanks, c);
}
inline bool is_space(char c) {
  return is_among(blanks | line_ends, c);
}

/// An end that need not be looked for: before it stands something at which whoever reads stops, the end of a
/// line for example. To look for ends takes a part of the time in which numbers are read.
struct FarEnd {
  const char* end;

  friend bool operator==(const char*, FarEnd) { return false; }
};

template <class End>
inline const char* skip_blanks(const char* at, End end) {
  while (at != end && is_blank(*at)) ++at;
  return at;
}

inline const char* skip_spaces(const char* at, const char* end) {
  while (at != end && is_space(*at)) ++at;
  return at;
}

/// The end of the word that begins at `at`.
template <class End>
inline const char* skip_word(const char* at, End end) {
  while (at != end && !is_space(*at)) ++at;
  return at;
}

/// The first `\n` or `\r` at or after `at`, or `end`.
inline const char* find_line_end(const char* at, const char* end) {
  // Eight bytes at once: a byte of `word ^ pattern` is zero where the byte is that of the pattern, and
  // subtracting one from it borrows into its high bit.
  constexpr std::uint64_t ones = 0x0101010101010101u, highs = 0x8080808080808080u;
  while (end - at >= 8) {
    std::uint64_t word;
    std::memcpy(&word, at, sizeof word);
    const std::uint64_t n = word ^ (ones * '\n'), r = word ^ (ones * '\r');
    if ((((n - ones) & ~n) | ((r - ones) & ~r)) & highs) break;
    at += 8;
  }
  while (at != end && !is_line_end(*at)) ++at;
  return at;
}

/// Behind the end of the line that ends at `at`.
inline const char* skip_line_end(const char* at, const char* end) {
  if (at != end && *at == '\r')
    ++at, at += at != end && *at == '\n';
  else if (at != end)
    ++at;
  return at;
}

/// The number, from 1, of the line of `text` that `at` is in.
inline std::size_t line_number(std::string_view text, const char* at) {
  std::size_t number = 1;
  for (const char *line = text.data(), *end = text.data() + text.size();;) {
    line = find_line_end(line, end);
    if (line >= at || line == end) return number;
    line = skip_line_end(line, end);
    if (line > at) return number;
    ++number;
  }
}

/// The number of the last line of `text` that is not blank.
inline std::size_t last_line_number(std::string_view text) {
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return line_number(text, text.data() + text.size());
}

/// Takes the first word from `rest`; empty if there is none.
inline std::string_view take_word(std::string_view& rest) {
  const char* const end = rest.data() + rest.size();
  const char* const begin = skip_spaces(rest.data(), end);
  const char* const behind = skip_word(begin, end);
  rest = {behind, static_cast<std::size_t>(end - behind)};
  return {begin, static_cast<std::size_t>(behind - begin)};
}

/// A word as an error shows it: its beginning, without what would break the line.
inline std::string_view shown(std::string_view word) {
  constexpr std::size_t max_length = 40;
  return word.substr(0, std::min(max_length, word.size()));
}

/// `text` without the mark that some editors put before UTF-8.
inline std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
}

}  // namespace workbench
