#include "workbench/formats/numbers.hpp"

#include <string_view>

namespace workbench {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// std::from_chars leaves open whether a number that is out of range is too large or too small.
template <class Number>
Number out_of_range(const char* begin, const char* end) {
  // The power of ten of the first digit that is not zero decides.
  long long power = 0;
  bool seen_digit = false, seen_point = false;
  const char* at = begin;
  for (; at != end && (is_digit(*at) || *at == '.'); ++at) {
    if (*at == '.') {
      seen_point = true;
      continue;
    }
    seen_digit = seen_digit || *at != '0';
    if (seen_digit && !seen_point) ++power;
    if (!seen_digit && seen_point) --power;
  }
  if (at != end && (*at == 'e' || *at == 'E')) {
    if (++at != end && *at == '+') ++at;
    const bool is_negative = at != end && *at == '-';
    constexpr long long max_exponent = 1'000'000'000'000;
    long long exponent = 0;
    for (at += is_negative; at != end && is_digit(*at); ++at)
      if (exponent < max_exponent) exponent = 10 * exponent + (*at - '0');
    power += is_negative ? -exponent : exponent;
  }
  return seen_digit && power > 0 ? std::numeric_limits<Number>::infinity() : Number{0};
}

template <class Number>
const char* parse(const char* begin, const char* end, Number& number) {
  const auto [behind, error] = std::from_chars(begin, end, number);
  if (error == std::errc::result_out_of_range) {
    number = out_of_range<Number>(begin, behind);
  } else if (error != std::errc()) {
    return nullptr;
  }
  return behind;
}

// What the C library of Microsoft printed for numbers that are none.
const char* parse_no_number(const char* begin, const char* end, double& number) {
  const std::string_view text(begin, static_cast<std::size_t>(end - begin));
  for (const std::string_view name : {"1.#INF", "1.#IND", "1.#QNAN", "1.#SNAN", "1.#NAN"}) {
    if (!text.starts_with(name)) continue;
    number = name.ends_with("INF") ? std::numeric_limits<double>::infinity()
                                   : std::numeric_limits<double>::quiet_NaN();
    const char* at = begin + name.size();
    while (at != end && *at == '0') ++at;
    return at;
  }
  return nullptr;
}

}  // namespace

Real parse_any_real(const char* begin, const char* end) {
  const bool is_negative = begin != end && *begin == '-';
  if (begin != end && (*begin == '-' || *begin == '+')) ++begin;
  if (begin == end || *begin == '-') return {};
  Real real;
  real.end = parse_no_number(begin, end, real.wide);
  if (real.end != nullptr) {
    real.nearest = static_cast<float>(real.wide);
  } else {
    real.end = parse(begin, end, real.wide);
    if (real.end == nullptr || parse(begin, end, real.nearest) == nullptr) return {};
  }
  if (is_negative) {
    real.wide = -real.wide;
    real.nearest = -real.nearest;
  }
  return real;
}

}  // namespace workbench
