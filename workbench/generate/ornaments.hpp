// Turned and carved things: smooth shapes of as many triangles as are asked for.
#pragma once

#include <span>

#include "workbench/generate/mesh_maker.hpp"

namespace workbench {

/// How finely to tessellate. Numbers of rows and segments are proportional to the square root of `detail`, so
/// that numbers of triangles are proportional to `detail`.
class Fineness {
 public:
  explicit Fineness(double detail);

  /// A number of rows or segments: `count` at detail 1, and never below `min`.
  std::uint32_t operator()(double count, std::uint32_t min = 3) const;

 private:
  double factor_;
};

/// The smooth curve through the points of a profile (a Catmull-Rom spline) at `t` from 0 to 1.
ProfilePoint profile_at(std::span<const ProfilePoint> profile, float t);

/// The surface of revolution of the smooth curve through the points of a profile, scaled by `scale`.
void add_turned(MeshMaker& maker, const kerf::Vec3f& foot, std::span<const ProfilePoint> profile, float scale,
                std::uint32_t segments, std::uint32_t rows);

/// A fluted column with a square plinth, a moulded base, a capital of leaves and an abacus on top.
void add_column(MeshMaker& maker, const kerf::Vec3f& foot, float height, float radius, const Fineness& fine);

void add_baluster(MeshMaker& maker, const kerf::Vec3f& foot, float height, const Fineness& fine);
void add_vase(MeshMaker& maker, const kerf::Vec3f& foot, float height, const Fineness& fine);

/// A flower in relief on a wall. `x` and `y` are unit vectors in the wall, and `x` cross `y` points away from
/// it.
void add_rosette(MeshMaker& maker, const kerf::Vec3f& center, const kerf::Vec3f& x, const kerf::Vec3f& y,
                 float radius, const Fineness& fine);

/// A ring. `x` and `y` are unit vectors in its plane.
void add_ring(MeshMaker& maker, const kerf::Vec3f& center, const kerf::Vec3f& x, const kerf::Vec3f& y,
              float radius, float thickness, std::uint32_t segments, std::uint32_t sides);

/// A cloth that hangs in folds from `left` to `right`, `length` down.
void add_drape(MeshMaker& maker, const kerf::Vec3f& left, const kerf::Vec3f& right, float length, float depth,
               std::uint32_t folds, const Fineness& fine);

/// A round cable between two points that sags by `sag` in its middle.
void add_cable(MeshMaker& maker, const kerf::Vec3f& from, const kerf::Vec3f& to, float sag, float radius,
               std::uint32_t segments, std::uint32_t sides);

}  // namespace workbench
