// Sums of products of floats without rounding (Shewchuk 1997, "Adaptive Precision Floating-Point Arithmetic
// and Fast Robust Geometric Predicates"), for the few decisions that double precision leaves open.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace kerf {

/// A sum of doubles, kept as an expansion: terms whose bits do not overlap, smallest first. No bit is lost.
///
/// Products of up to four floats neither overflow nor underflow in double precision (2^512 and 2^-596 are in
/// its range), so that everything added here is exact. Must be compiled without contraction and with plain
/// double arithmetic.
class ExactSum {
 public:
  /// The maximum number of terms that a predicate adds: 24 products of three floats and 18 of four, two each.
  static constexpr std::size_t capacity = 84;

  void add(double term) {
    double carry = term;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double sum = carry + terms_[i];
      const double added = sum - carry;
      const double error = (carry - (sum - added)) + (terms_[i] - added);
      if (error != 0.0) terms_[kept++] = error;
      carry = sum;
    }
    if (carry != 0.0) terms_[kept++] = carry;
    count_ = kept;
  }

  /// A product of two floats has 48 bits, which a double holds.
  void add_product(float x, float y) { add(static_cast<double>(x) * y); }

  /// A product of three floats has 72 bits. The product of the first two is split in halves (Veltkamp's
  /// splitting), whose products with the third are exact.
  void add_product(float x, float y, float z) {
    constexpr double splitter = (1 << 27) + 1;  // leaves 26 bits in each half of the 53
    const double product = static_cast<double>(x) * y;
    const double scaled = splitter * product;
    const double high = scaled - (scaled - product);
    add(high * z);
    add((product - high) * z);
  }

  /// A product of four floats has 96 bits. What a double loses of it is a double, too.
  void add_product(float x, float y, float z, float w) {
    const double xy = static_cast<double>(x) * y, zw = static_cast<double>(z) * w;
    const double product = xy * zw;
    add(product);
    add(std::fma(xy, zw, -product));
  }

  /// -1, 0 or 1. The sign of the largest term is the sign of the sum.
  int sign() const {
    if (count_ == 0) return 0;
    return terms_[count_ - 1] > 0.0 ? 1 : -1;
  }

  /// The sum, rounded.
  double value() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < count_; ++i) sum += terms_[i];
    return sum;
  }

 private:
  std::array<double, capacity> terms_;
  std::size_t count_ = 0;
};

}  // namespace kerf
