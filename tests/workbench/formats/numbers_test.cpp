#include "workbench/formats/numbers.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace workbench {
namespace {

// `text` must outlive the result, which points to its end.
Real parse(std::string_view text) {
  return parse_real(text.data(), text.data() + text.size());
}

// The C library rounds correctly as well, on its own way.
void expect_nearest(const std::string& text) {
  const Real real = parse(text);
  ASSERT_NE(real.end, nullptr) << text;
  EXPECT_EQ(real.nearest, std::strtof(text.c_str(), nullptr)) << text;
  EXPECT_EQ(real.wide, std::strtod(text.c_str(), nullptr)) << text;
  EXPECT_EQ(std::signbit(real.nearest), std::signbit(std::strtof(text.c_str(), nullptr))) << text;
}

TEST(Numbers, AreTheFloatsNearestToTheText) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const auto digits = static_cast<double>(random() % 1'000'000'000) / 1e4;
    expect_nearest(fmt::format("{}{:.{}f}", i % 2 ? "-" : "", digits, i % 12));
    expect_nearest(fmt::format(
        "{:.{}e}", std::ldexp(static_cast<double>(random() >> 11), static_cast<int>(random() % 400) - 250),
        i % 20));
  }
}

TEST(Numbers, AreRoundedOnceAlsoBetweenTwoFloats) {
  std::mt19937 random(2);
  for (int i = 0; i < 2000; ++i) {
    const float low =
        std::ldexp(static_cast<float>(random() >> 8 | 0x800000), static_cast<int>(random() % 40) - 40);
    const double half = 0.5 * (double{low} + double{std::nextafter(low, 1e30f)});
    expect_nearest(fmt::format("{:.60f}", half));
    expect_nearest(fmt::format("{:.60f}1", half));  // just above, where doubles do not see it
    expect_nearest(fmt::format("{:.17g}", half));
  }
}

TEST(Numbers, MayBeWrittenInAnyForm) {
  for (const char* text :
       {"0", "-0", "+1", "1.", ".5", "-.5e3", "1e5", "1E+5", "00001.5000", "1e-46", "7e-46", "1.17549435e-38",
        "1e-320", "123456789012345678901234567890", "0.00000000000000000000000000000000000000000000012345",
        "3.4028235677973366e38", "0e99999999999", "16777217", "16777219.0"}) {
    const Real real = parse(text);
    ASSERT_NE(real.end, nullptr) << text;
    EXPECT_EQ(*real.end, '\0') << text;
    if (text[0] != '+') expect_nearest(text);
  }
}

TEST(Numbers, OutOfRangeAreZeroOrInfinite) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(parse("1e-99999999999999999999").nearest, 0.0f);
  EXPECT_EQ(parse("0." + std::string(500, '0') + "1").nearest, 0.0f);
  EXPECT_EQ(parse("1e39").nearest, infinity);
  EXPECT_EQ(parse("1e39").wide, 1e39);
  EXPECT_EQ(parse("-1e400").nearest, -infinity);
  EXPECT_EQ(parse("1e99999999999999999999").nearest, infinity);
  EXPECT_EQ(parse(std::string(400, '9')).wide, std::numeric_limits<double>::infinity());
}

TEST(Numbers, KnowWhatIsPrintedForNoNumber) {
  for (const char* text :
       {"nan", "-nan", "NaN", "inf", "-inf", "Infinity", "1.#QNAN", "-1.#IND00", "1.#INF", "-1.#INF"}) {
    const Real real = parse(text);
    ASSERT_NE(real.end, nullptr) << text;
    EXPECT_EQ(*real.end, '\0') << text;
    EXPECT_FALSE(std::isfinite(real.nearest)) << text;
    EXPECT_EQ(real.remainder(), 0.0f);
  }
}

TEST(Numbers, EndWhereNoNumberGoesOn) {
  EXPECT_EQ(parse("").end, nullptr);
  EXPECT_EQ(parse("x").end, nullptr);
  EXPECT_EQ(parse("-").end, nullptr);
  EXPECT_EQ(parse("+-1").end, nullptr);
  EXPECT_EQ(parse(".").end, nullptr);
  EXPECT_EQ(*parse("0,5").end, ',');
  EXPECT_EQ(*parse("1.5f").end, 'f');
}

TEST(Numbers, KeepWhatRoundingToFloatsTakes) {
  EXPECT_EQ(parse("0.5").remainder(), 0.0f);
  EXPECT_EQ(parse("16777217").remainder(), 1.0f);
  EXPECT_EQ(parse("500000.01").remainder(), static_cast<float>(500000.01 - 500000.0));
}

TEST(Numbers, RowsOfDigitsEndAtTheFirstByteThatIsNone) {
  std::mt19937 random(3);
  for (int i = 0; i < 20'000; ++i) {
    std::string text;
    std::uint64_t expected = 7;  // digits that were read before
    const std::size_t count = random() % 18;
    for (std::size_t k = 0; k < count; ++k) {
      text += static_cast<char>('0' + random() % 10);
      expected = 10 * expected + static_cast<std::uint64_t>(text.back() - '0');
    }
    const std::size_t rest = random() % 10;  // so that eight bytes are there or not
    for (std::size_t k = 0; k < rest; ++k) {
      char other = static_cast<char>(random());
      if (k == 0 && '0' <= other && other <= '9') other = '/';
      text += other;
    }
    const char *const begin = text.data(), *const end = begin + text.size();
    std::uint64_t number = 7;
    EXPECT_EQ(read_digits(begin, end, number) - begin, static_cast<std::ptrdiff_t>(count)) << text;
    EXPECT_EQ(number, expected) << text;
    if (rest == 0) continue;
    number = 7;
    EXPECT_EQ(read_digits(begin, FarEnd{end}, number) - begin, static_cast<std::ptrdiff_t>(count)) << text;
    EXPECT_EQ(number, expected) << text;
  }
}

TEST(Numbers, WholeOnesSaturate) {
  const auto whole = [](const std::string& text) {
    return parse_whole(text.data(), text.data() + text.size());
  };
  EXPECT_EQ(whole("-17/3").value, -17);
  EXPECT_EQ(*whole("-17/3").end, '/');
  EXPECT_EQ(whole("+0012").value, 12);
  EXPECT_EQ(whole("000000000000000000000000000012").value, 12);
  EXPECT_EQ(whole("99999999999999999999999999").value, std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(whole("-99999999999999999999999999").value, -std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(whole("/").end, nullptr);
}

}  // namespace
}  // namespace workbench
