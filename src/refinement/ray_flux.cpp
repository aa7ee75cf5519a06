#include "refinement/ray_flux.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "math/box3f.hpp"

namespace kerf {
namespace {

// So many rays, and this share of the others, count as if they went everywhere: a box that none meets would
// cost nothing, wherever it came to lie.
constexpr float min_everywhere = 32.0f, share_everywhere = 0.005f;

// An axis along which the scene is flat has a grid all the same.
constexpr float min_extent = 1e-3f;  // of the longest

constexpr int next(int axis) {
  return (axis + 1) % 3;
}

bool is_inside(float coordinate) {
  return coordinate >= 0.0f && coordinate <= static_cast<float>(RayFlux::cells);
}

// Where the sum up to the cell of a coordinate, the cell included, stands.
std::size_t sum_at(float coordinate) {
  return std::min(static_cast<std::size_t>(coordinate) + 1, static_cast<std::size_t>(RayFlux::cells));
}

}  // namespace

RayFlux::RayFlux(const Box3f& scene, std::span<const Ray> ways) {
  const Vec3f size = extent(scene);
  const float longest = std::max({size.x, size.y, size.z});
  for (int axis = 0; axis < 3; ++axis) {
    const float length = std::max(size[axis], min_extent * longest);
    lower_[axis] = scene.lower[axis] - 0.5f * (length - size[axis]);
    scale_[axis] = static_cast<float>(cells) / length;
  }
  everywhere_ = (min_everywhere + share_everywhere * static_cast<float>(ways.size())) / half_area(scene);
  parallel_for(std::size_t{7}, [&](std::size_t table) {
    if (table == 6) {
      starting_ = starting(ways);
    } else {
      crossing_[table / 2][table % 2] = crossing(static_cast<int>(table / 2), table % 2 != 0, ways);
    }
  });
}

RayFlux::Way RayFlux::in_grid(const Ray& ray) const {
  Way way{{}, {}, ray.t_min, ray.t_max};
  for (int axis = 0; axis < 3; ++axis) {
    way.origin[axis] = (ray.origin[axis] - lower_[axis]) * scale_[axis];
    way.direction[axis] = ray.direction[axis] * scale_[axis];
  }
  return way;
}

RayFlux::Table RayFlux::crossing(int axis, bool downwards, std::span<const Ray> ways) const {
  Table counts(table_size);
  const int second = next(axis), third = next(second);
  for (const Ray& ray : ways) {
    const Way way = in_grid(ray);
    const float step = way.direction[axis];
    if (!(downwards ? step < 0.0f : step > 0.0f)) continue;
    for (std::size_t plane = 0; plane < side; ++plane) {
      const float t = (static_cast<float>(plane) - way.origin[axis]) / step;
      if (!(t >= way.t_min && t <= way.t_max)) continue;
      const float row = way.origin[second] + t * way.direction[second];
      const float column = way.origin[third] + t * way.direction[third];
      if (is_inside(row) && is_inside(column)) counts[index(plane, sum_at(row), sum_at(column))] += 1.0f;
    }
  }
  for (std::size_t plane = 0; plane < side; ++plane) sum_up(&counts[index(plane, 0, 0)]);
  return counts;
}

RayFlux::Table RayFlux::starting(std::span<const Ray> ways) const {
  Table counts(table_size);
  for (const Ray& ray : ways) {
    const Way way = in_grid(ray);
    const Vec3f start = way.origin + way.t_min * way.direction;
    if (is_inside(start.x) && is_inside(start.y) && is_inside(start.z))
      counts[index(sum_at(start.x), sum_at(start.y), sum_at(start.z))] += 1.0f;
  }
  for (std::size_t plane = 0; plane < side; ++plane) sum_up(&counts[index(plane, 0, 0)]);
  for (std::size_t i = index(1, 0, 0); i < table_size; ++i) counts[i] += counts[i - index(1, 0, 0)];
  return counts;
}

// Makes the counts of the cells of a plane sums over rectangles, which hold at most 2^18 rays: exact in
// floats.
void RayFlux::sum_up(float* plane) {
  for (std::size_t j = 1; j < side; ++j) {
    for (std::size_t k = 1; k < side; ++k)
      plane[j * side + k] +=
          plane[(j - 1) * side + k] + plane[j * side + k - 1] - plane[(j - 1) * side + k - 1];
  }
}

RayFlux::Place RayFlux::place(float coordinate) {
  const float inside = std::clamp(coordinate, 0.0f, static_cast<float>(cells));
  const std::size_t before = std::min(static_cast<std::size_t>(inside), side - 2);
  return {before, inside - static_cast<float>(before)};
}

float RayFlux::in_rectangle(const float* plane, const std::array<Place, 2>& rows,
                            const std::array<Place, 2>& columns) {
  const auto sum_to = [&](const Place& row, const Place& column) {
    const float* upper = plane + row.before * side + column.before;
    const float* lower = upper + side;
    const float in_upper = upper[0] + column.fraction * (upper[1] - upper[0]);
    const float in_lower = lower[0] + column.fraction * (lower[1] - lower[0]);
    return in_upper + row.fraction * (in_lower - in_upper);
  };
  return (sum_to(rows[1], columns[1]) - sum_to(rows[0], columns[1])) -
         (sum_to(rows[1], columns[0]) - sum_to(rows[0], columns[0]));
}

float RayFlux::at(const Table& table, const Place& plane, const std::array<Place, 2>& rows,
                  const std::array<Place, 2>& columns) {
  const float before = in_rectangle(&table[index(plane.before, 0, 0)], rows, columns);
  const float behind = in_rectangle(&table[index(plane.before + 1, 0, 0)], rows, columns);
  return before + plane.fraction * (behind - before);
}

float RayFlux::operator()(const Box3f& box) const {
  if (box.empty()) return 0.0f;
  std::array<std::array<Place, 2>, 3> places;  // of the sides, along each axis
  for (int axis = 0; axis < 3; ++axis) {
    places[static_cast<std::size_t>(axis)] = {place((box.lower[axis] - lower_[axis]) * scale_[axis]),
                                              place((box.upper[axis] - lower_[axis]) * scale_[axis])};
  }
  float rays = everywhere_ * half_area(box);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::array<Place, 2>& rows = places[(axis + 1) % 3];
    const std::array<Place, 2>& columns = places[(axis + 2) % 3];
    rays += at(crossing_[axis][0], places[axis][0], rows, columns);
    rays += at(crossing_[axis][1], places[axis][1], rows, columns);
  }
  rays +=
      at(starting_, places[0][1], places[1], places[2]) - at(starting_, places[0][0], places[1], places[2]);
  return rays;
}

}  // namespace kerf
