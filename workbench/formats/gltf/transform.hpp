// Affine transforms in double precision.
#pragma once

#include <array>
#include <cmath>

namespace workbench::gltf {

/// Three rows of four: what is added to a point is the last column.
struct Transform {
  std::array<std::array<double, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  bool operator==(const Transform&) const = default;

  std::array<double, 3> operator()(const std::array<double, 3>& p) const {
    std::array<double, 3> q;
    for (std::size_t i = 0; i < 3; ++i)
      q[i] = rows[i][0] * p[0] + rows[i][1] * p[1] + rows[i][2] * p[2] + rows[i][3];
    return q;
  }
};

/// First `b`, then `a`.
inline Transform operator*(const Transform& a, const Transform& b) {
  Transform c;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      c.rows[i][j] = a.rows[i][0] * b.rows[0][j] + a.rows[i][1] * b.rows[1][j] + a.rows[i][2] * b.rows[2][j] +
                     (j == 3 ? a.rows[i][3] : 0.0);
    }
  }
  return c;
}

/// Of sixteen numbers, column by column. The last row is taken for (0 0 0 1).
inline Transform from_columns(const std::array<double, 16>& m) {
  Transform t;
  for (std::size_t i = 0; i < 3; ++i) t.rows[i] = {m[i], m[4 + i], m[8 + i], m[12 + i]};
  return t;
}

/// First scaled, then rotated by the quaternion (x y z w), then moved.
inline Transform from_parts(const std::array<double, 3>& translation, const std::array<double, 4>& rotation,
                            const std::array<double, 3>& scale) {
  const auto [x, y, z, w] = rotation;
  const double norm = x * x + y * y + z * z + w * w;
  const double s = norm > 0.0 ? 2.0 / norm : 0.0;
  const std::array<std::array<double, 3>, 3> turned{
      {{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)},
       {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)},
       {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)}}};
  Transform t;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) t.rows[i][j] = turned[i][j] * scale[j];
    t.rows[i][3] = translation[i];
  }
  return t;
}

}  // namespace workbench::gltf
