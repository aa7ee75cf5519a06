// The way from an object through scenes in scenes to the outermost one.
#pragma once

#include <kerf/query.hpp>
#include <kerf/triangle.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// The map that is `first` followed by `second`.
inline Transform followed(const Transform& first, const Transform& second) {
  Transform both;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      both.rows[i][j] = j == 3 ? second.rows[i][3] : 0.0;
      for (int k = 0; k < 3; ++k) both.rows[i][j] += second.rows[i][k] * first.rows[k][j];
    }
  }
  return both;
}

/// The transforms of one instance on each level, the innermost first. They are applied one after another and
/// not multiplied: the boxes of each level allow for the rounding of its own map alone.
struct Chain {
  const Transform& transform;
  const Chain* above;  ///< null in the outermost scene

  /// A corner in the scene: each level in double precision and in one order, rounded to floats once at last.
  Vec3f operator()(const Vec3f& corner) const {
    double at[3] = {corner.x, corner.y, corner.z};
    for (const Chain* level = this; level != nullptr; level = level->above) {
      double moved[3];
      for (int i = 0; i < 3; ++i) {
        const double(&row)[4] = level->transform.rows[i];
        moved[i] = row[0] * at[0] + row[1] * at[1] + row[2] * at[2] + row[3];
      }
      for (int i = 0; i < 3; ++i) at[i] = moved[i];
    }
    return {static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2])};
  }
  /// All of it as one map.
  Transform whole() const {
    Transform product = transform;
    for (const Chain* level = above; level != nullptr; level = level->above)
      product = followed(product, level->transform);
    return product;
  }

  Triangle operator()(const Triangle& t) const { return {(*this)(t.v0), (*this)(t.v1), (*this)(t.v2)}; }
};

}  // namespace kerf
