// Numbers as files spell them.
#pragma once

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "workbench/formats/text.hpp"

namespace workbench {

/// A number of a text.
struct Real {
  double wide = 0.0;     ///< the double nearest to what is written
  float nearest = 0.0f;  ///< the float nearest to what is written
  const char* end = {};  ///< behind the number; null if there is none

  /// What rounding to a float took; 0 of what is not finite.
  float remainder() const {
    return std::isfinite(nearest) ? static_cast<float>(wide - double{nearest}) : 0.0f;
  }
};

/// What the general case costs is spent outside of `parse_real`.
Real parse_any_real(const char* begin, const char* end);
inline Real parse_any_real(const char* begin, FarEnd far) {
  return parse_any_real(begin, far.end);
}

/// A row of digits at the beginning of a text, as far as the first eight bytes go.
struct Digits {
  std::uint64_t value = 0;
  std::uint32_t count = 0;  ///< at most 8
};

/// All eight at once (Lemire 2021, "Number Parsing at a Gigabyte per Second"): a digit after another takes a
/// multiplication and a branch each. Reads eight bytes, on a machine that has the first one lowest.
inline Digits eight_digits(const char* at) {
  std::uint64_t bytes;
  std::memcpy(&bytes, at, sizeof bytes);
  const std::uint64_t x = bytes ^ 0x3030303030303030u;  // digits are 0 to 9 now
  // The high bit of each byte that is none; above the first of these, carries may set others.
  const std::uint64_t others = (x | (x + 0x7676767676767676u)) & 0x8080808080808080u;
  const auto count = static_cast<std::uint32_t>(std::countr_zero(others)) / 8;
  if (count == 0) return {};
  std::uint64_t value = x << (64 - 8 * count);  // with zeros before
  value = (value * 10 + (value >> 8)) & 0x00ff00ff00ff00ffu;
  value = (value * 100 + (value >> 16)) & 0x0000ffff0000ffffu;
  value = (value * 10000 + (value >> 32)) & 0xffffffffu;
  return {value, count};
}

inline bool has_eight(const char* at, const char* end) {
  return std::endian::native == std::endian::little && end - at >= 8;
}
inline bool has_eight(const char* at, FarEnd far) {
  return has_eight(at, far.end);
}

inline constexpr std::uint64_t powers_of_ten[] = {1,      10,      100,      1000,     10000,
                                                  100000, 1000000, 10000000, 100000000};

/// Reads the row of digits at `at` behind those that `number` has already, which may overflow.
template <class End>
inline const char* read_digits(const char* at, End end, std::uint64_t& number) {
  if (has_eight(at, end)) {
    const Digits digits = eight_digits(at);
    number = number * powers_of_ten[digits.count] + digits.value;
    at += digits.count;
    if (digits.count < 8) return at;
  }
  while (at != end && static_cast<unsigned char>(*at - '0') < 10)
    number = 10 * number + static_cast<unsigned char>(*at++ - '0');
  return at;
}

/// The number that begins at `begin`, with a decimal point and an exponent or without. Too small a number is
/// 0, too large a one infinite. What the C libraries print for no number ("nan", "-inf", "-1.#IND") is read
/// as such.
template <class End>
inline Real parse_real(const char* begin, End end) {
  // Clinger's fast path (1990): whole numbers up to 2^53 and powers of ten up to 10^22 are exact in doubles,
  // so their product or quotient is rounded once.
  static constexpr double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  constexpr int max_power = 22, max_digits = 19;  // 19 digits always fit into 64 bits
  const char* at = begin;
  const bool is_negative = at != end && *at == '-';
  if (at != end && (*at == '-' || *at == '+')) ++at;
  std::uint64_t digits = 0;
  const char* const first = at;
  while (at != end && static_cast<unsigned char>(*at - '0') < 10)
    digits = 10 * digits + static_cast<unsigned char>(*at++ - '0');
  std::ptrdiff_t count = at - first;
  std::ptrdiff_t power = 0;
  if (at != end && *at == '.') {
    const char* const fraction = ++at;
    at = read_digits(at, end, digits);
    power = fraction - at;
    count += at - fraction;
  }
  if (count == 0 || count > max_digits || digits > std::uint64_t{1} << 53 ||
      (at != end && (*at == 'e' || *at == 'E' || *at == '#')) || power < -max_power)
    return parse_any_real(begin, end);
  const double value = static_cast<double>(digits) / powers[-power];
  // Rounding twice, to double and then to float, differs from rounding once only if the first ends halfway
  // between two floats.
  constexpr std::uint64_t low_bits = (std::uint64_t{1} << 29) - 1, halfway = std::uint64_t{1} << 28;
  if ((std::bit_cast<std::uint64_t>(value) & low_bits) == halfway ||
      (value < std::numeric_limits<float>::min() && value != 0.0))
    return parse_any_real(begin, end);
  const double wide = is_negative ? -value : value;
  return {wide, static_cast<float>(wide), at};
}

/// The whole number that begins at `begin`; `end` is null if there is none. Numbers that 64 bits cannot hold
/// become the largest or the smallest one.
struct Whole {
  std::int64_t value = 0;
  const char* end = {};
};

inline Whole parse_whole(const char* begin, const char* end) {
  const char* at = begin;
  const bool is_negative = at != end && *at == '-';
  if (at != end && (*at == '-' || *at == '+')) ++at;
  const char* const first = at;
  std::uint64_t value = 0;
  while (at != end && static_cast<unsigned char>(*at - '0') < 10)
    value = 10 * value + static_cast<unsigned char>(*at++ - '0');
  if (at == first) return {};
  constexpr std::ptrdiff_t max_digits = 18;
  if (at - first > max_digits) {
    const char* significant = first;
    while (significant != at && *significant == '0') ++significant;
    if (at - significant > max_digits)
      value = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  }
  const auto whole = static_cast<std::int64_t>(value);
  return {is_negative ? -whole : whole, at};
}

}  // namespace workbench
