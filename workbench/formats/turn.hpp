// On which side of a line a point is, exactly.
#pragma once

#include <cmath>

namespace workbench {

/// The sign of the exact sum of six doubles.
int sign_of_sum(const double (&terms)[6]);

/// 1 if a, b, c turn left in the plane, -1 if right, 0 if they are on a line: exactly, for coordinates that
/// are floats.
template <class Point>
int turn(const Point& a, const Point& b, const Point& c) {
  const double ax = a.x, ay = a.y, bx = b.x, by = b.y, cx = c.x, cy = c.y;
  const double plus = (bx - ax) * (cy - ay), minus = (by - ay) * (cx - ax), area = plus - minus;
  // Each difference, each product and the difference of the two is off by 2^-53 of itself.
  const double rounding = 0x1p-50 * (std::abs(plus) + std::abs(minus));
  if (area > rounding) return 1;
  if (area < -rounding) return -1;
  // Products of two floats are exact in doubles.
  return sign_of_sum({bx * cy, -(bx * ay), -(ax * cy), -(by * cx), by * ax, ay * cx});
}

}  // namespace workbench
