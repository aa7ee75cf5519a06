// How many of a set of rays meet a box, in constant time.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <kerf/ray.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// The measure of boxes by rays that are known, in place of half the area, which is that of rays of all kinds
/// (Bittner & Havran 2009, "RDH: Ray Distribution Heuristics for Construction of Spatial Hierarchies"). A ray
/// meets a convex box if it starts inside, or else enters through one of its six sides, and then through no
/// other. So the scene is cut into a grid, and for each of its planes and either way across, sums over
/// rectangles of where rays cross it are kept; the number for a box is looked up along its sides and
/// interpolated. Within a cell of the grid rays count as spread evenly.
class RayFlux {
 public:
  static constexpr int cells = 64;  ///< along each axis

  /// Of the ways of rays, from `t_min` to `t_max`. `scene` has a finite area above 0. On all threads of the
  /// task arena that this is called in.
  RayFlux(const Box3f& scene, std::span<const Ray> ways);

  /// About how many ways meet the box, which lies in the scene, and a little more: some rays count as if they
  /// went everywhere.
  float operator()(const Box3f& box) const;

  static constexpr std::size_t bytes() { return 7 * table_size * sizeof(float); }

 private:
  static constexpr std::size_t side = cells + 1, table_size = side * side * side;
  using Table = std::vector<float>;

  // A place between two planes, or two columns of sums.
  struct Place {
    std::size_t before;
    float fraction;
  };

  // A ray in the grid.
  struct Way {
    Vec3f origin, direction;
    float t_min, t_max;
  };
  Way in_grid(const Ray& ray) const;
  Table crossing(int axis, bool downwards, std::span<const Ray> ways) const;
  Table starting(std::span<const Ray> ways) const;

  static void sum_up(float* plane);
  static std::size_t index(std::size_t i, std::size_t j, std::size_t k) { return (i * side + j) * side + k; }
  static Place place(float coordinate);
  static float in_rectangle(const float* plane, const std::array<Place, 2>& rows,
                            const std::array<Place, 2>& columns);
  static float at(const Table& table, const Place& plane, const std::array<Place, 2>& rows,
                  const std::array<Place, 2>& columns);

  Vec3f lower_, scale_;                           // of the grid, whose cells have an edge of 1
  float everywhere_;                              // rays for each half area
  std::array<std::array<Table, 2>, 3> crossing_;  // of each axis: upwards, downwards
  Table starting_;
};

}  // namespace kerf
