// Polygons into triangles, for every format alike.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <kerf/vec.hpp>

namespace workbench {

/// Cuts polygons into triangles by ears (Meisters 1975). All decisions are exact. The memory that a polygon
/// needs is used again for the next one.
class Triangulator {
 public:
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;

  /// Appends the triangles of a polygon, which has three corners or more, all of them indices into
  /// `vertices`. There are two triangles fewer than corners.
  ///
  /// The triangles cover the outline, also where it is concave, has corners on a straight line, or goes to a
  /// hole and back. Corners that enclose nothing (repeated ones, the tip of a way there and back) become
  /// triangles without an area. A polygon in space is cut as its projection along the axis nearest to its
  /// normal.
  ///
  /// An outline that crosses itself encloses nothing certain. It is covered somehow, and counted if that is
  /// noticed.
  void append(std::span<const kerf::Vec3f> vertices, std::span<const std::uint32_t> polygon,
              Triangles& triangles);

  /// How many polygons so far were seen to have outlines that cross themselves.
  std::size_t crossing() const { return crossing_; }

 private:
  struct Corner {
    float x, y;
    std::uint32_t before, after;  ///< the neighbours that are left
    bool may_block;               ///< is left, and not convex: an ear must not contain it
  };

  void flatten(std::span<const kerf::Vec3f> vertices, std::span<const std::uint32_t> polygon);
  void fill_grid();
  int turn_at(std::uint32_t corner) const;
  bool is_dead_end(std::uint32_t corner) const;
  bool is_ear(std::uint32_t corner, bool touching_allowed);
  void cut(std::uint32_t corner);
  void cut_dead_ends(std::uint32_t corner);
  void cut_all();
  std::uint32_t cell_of(double position, double lower, double scale) const;

  std::span<const std::uint32_t> polygon_;
  Triangles* triangles_ = nullptr;
  std::vector<Corner> corners_;
  std::size_t left_ = 0;  ///< corners that are not cut off yet

  // A grid over the polygon: the corners in each cell, row by row.
  std::vector<std::uint32_t> cell_begin_, cell_corners_;
  std::uint32_t columns_ = 1;
  double lower_x_ = 0, lower_y_ = 0, scale_x_ = 0, scale_y_ = 0;

  std::uint64_t tests_left_ = 0;  ///< corners that may still be tested against ears
  std::size_t crossing_ = 0;
};

}  // namespace workbench
