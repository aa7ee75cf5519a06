// Sines and cosines that are the same on every machine, unlike those of the C library.
#pragma once

#include <cmath>

namespace workbench {

struct SineCosine {
  float sine;
  float cosine;
};

/// The sine and cosine of an angle in full turns: 0.25 is a right angle. They are exact at quarter turns and
/// elsewhere accurate to about an ulp.
///
/// Evaluates Taylor series in double precision on an eighth of a turn, with operations that IEEE 754 defines
/// exactly.
inline SineCosine sine_cosine(double turns) {
  const double quarters = turns * 4.0;
  const double nearest = std::floor(quarters + 0.5);
  constexpr double half_pi = 1.57079632679489661923;
  const double x = (quarters - nearest) * half_pi;  // in [-pi/4, pi/4]
  const double x2 = x * x;
  const double s =
      x *
      (1.0 + x2 * (-1.0 / 6 + x2 * (1.0 / 120 + x2 * (-1.0 / 5040 + x2 * (1.0 / 362880 - x2 / 39916800)))));
  const double c =
      1.0 + x2 * (-0.5 + x2 * (1.0 / 24 + x2 * (-1.0 / 720 + x2 * (1.0 / 40320 - x2 / 3628800))));
  const auto sine = static_cast<float>(s), cosine = static_cast<float>(c);
  switch (static_cast<int>(nearest - 4.0 * std::floor(nearest / 4.0))) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

}  // namespace workbench
