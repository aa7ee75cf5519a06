#include "workbench/formats/triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "workbench/formats/turn.hpp"

namespace workbench {
namespace {

/// Corners that are tested against ears, for each corner of a polygon. A simple polygon needs few of them
/// thanks to the grid, and less than a thousand corners never need so many without it.
constexpr std::uint64_t tests_per_corner = 20'000;

/// The same for a polygon that crosses itself: what it encloses is uncertain anyway.
constexpr std::uint64_t tests_per_crossing_corner = 100;

/// Smaller polygons are searched without a grid.
constexpr std::size_t min_corners_of_grid = 40;

template <class Point>
bool same_place(const Point& a, const Point& b) {
  return a.x == b.x && a.y == b.y;
}

}  // namespace

// The polygon projected along the axis nearest to its normal, so that it goes round counter-clockwise. The
// normal is Newell's: the sum of the cross products of neighbours (Sutherland, Sproull & Schumacker 1974).
void Triangulator::flatten(std::span<const kerf::Vec3f> vertices, std::span<const std::uint32_t> polygon) {
  double normal[3] = {0, 0, 0};
  const kerf::Vec3f& o = vertices[polygon[0]];
  const auto from_o = [&](std::uint32_t vertex) {
    const kerf::Vec3f& p = vertices[vertex];
    return std::array{double{p.x} - o.x, double{p.y} - o.y, double{p.z} - o.z};
  };
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const auto [ax, ay, az] = from_o(polygon[i]);
    const auto [bx, by, bz] = from_o(polygon[i + 1]);
    normal[0] += ay * bz - az * by;
    normal[1] += az * bx - ax * bz;
    normal[2] += ax * by - ay * bx;
  }
  int axis = 0;
  for (int i = 1; i < 3; ++i) axis = std::abs(normal[i]) > std::abs(normal[axis]) ? i : axis;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (normal[axis] < 0) std::swap(u, v);
  corners_.clear();
  const auto n = static_cast<std::uint32_t>(polygon.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    const kerf::Vec3f& p = vertices[polygon[i]];
    corners_.push_back({p[u], p[v], (i + n - 1) % n, (i + 1) % n, false});
  }
  for (std::uint32_t i = 0; i < n; ++i) corners_[i].may_block = turn_at(i) <= 0;
}

std::uint32_t Triangulator::cell_of(double position, double lower, double scale) const {
  const double cell = (position - lower) * scale;
  return cell < 0.0 ? 0 : std::min(static_cast<std::uint32_t>(std::min(cell, 1e6)), columns_ - 1);
}

void Triangulator::fill_grid() {
  const std::size_t n = corners_.size();
  columns_ = n < min_corners_of_grid ? 1 : static_cast<std::uint32_t>(std::sqrt(static_cast<double>(n)));
  double upper_x = -std::numeric_limits<double>::infinity(), upper_y = upper_x;
  lower_x_ = lower_y_ = -upper_x;
  for (const Corner& corner : corners_) {
    lower_x_ = std::min<double>(lower_x_, corner.x);
    lower_y_ = std::min<double>(lower_y_, corner.y);
    upper_x = std::max<double>(upper_x, corner.x);
    upper_y = std::max<double>(upper_y, corner.y);
  }
  scale_x_ = upper_x > lower_x_ ? columns_ / (upper_x - lower_x_) : 0.0;
  scale_y_ = upper_y > lower_y_ ? columns_ / (upper_y - lower_y_) : 0.0;
  const auto cell = [&](const Corner& corner) {
    return cell_of(corner.y, lower_y_, scale_y_) * columns_ + cell_of(corner.x, lower_x_, scale_x_);
  };
  cell_begin_.assign(std::size_t{columns_} * columns_ + 1, 0);
  for (const Corner& corner : corners_) ++cell_begin_[cell(corner) + 1];
  for (std::size_t i = 1; i < cell_begin_.size(); ++i) cell_begin_[i] += cell_begin_[i - 1];
  cell_corners_.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) cell_corners_[cell_begin_[cell(corners_[i])]++] = i;
  for (std::size_t i = cell_begin_.size() - 1; i > 0; --i) cell_begin_[i] = cell_begin_[i - 1];
  cell_begin_[0] = 0;
}

int Triangulator::turn_at(std::uint32_t corner) const {
  const Corner& b = corners_[corner];
  return turn(corners_[b.before], b, corners_[b.after]);
}

// True if the outline comes back from the corner on the way on which it went there.
bool Triangulator::is_dead_end(std::uint32_t corner) const {
  const Corner &b = corners_[corner], &a = corners_[b.before], &c = corners_[b.after];
  if (same_place(a, b) || same_place(b, c) || same_place(a, c)) return true;
  const bool is_between = std::min(a.x, c.x) <= b.x && b.x <= std::max(a.x, c.x) &&
                          std::min(a.y, c.y) <= b.y && b.y <= std::max(a.y, c.y);
  return !is_between && turn(a, b, c) == 0;
}

// True if the triangle at the corner, which turns left, contains no other corner. One that only touches a
// side of the triangle that is the outline's may be allowed, if the outline does not go into the triangle
// from there.
bool Triangulator::is_ear(std::uint32_t corner, bool touching_allowed) {
  const Corner &b = corners_[corner], &a = corners_[b.before], &c = corners_[b.after];
  const auto blocks = [&](std::uint32_t number) {
    const Corner& p = corners_[number];
    if (!p.may_block || number == b.before || number == b.after) return false;
    if (same_place(p, a) || same_place(p, b) || same_place(p, c)) return false;
    const int of_ab = turn(a, b, p), of_bc = turn(b, c, p), of_ca = turn(c, a, p);
    if (of_ab < 0 || of_bc < 0 || of_ca < 0) return false;
    if (!touching_allowed || of_ca == 0 || (of_ab > 0 && of_bc > 0)) return true;
    const Corner &from = of_ab == 0 ? a : b, &to = of_ab == 0 ? b : c;
    return turn(from, to, corners_[p.before]) > 0 || turn(from, to, corners_[p.after]) > 0;
  };
  const auto [left, right] = std::minmax({a.x, b.x, c.x});
  const auto [bottom, top] = std::minmax({a.y, b.y, c.y});
  const std::uint32_t begin_x = cell_of(left, lower_x_, scale_x_),
                      end_x = cell_of(right, lower_x_, scale_x_) + 1;
  const std::uint32_t begin_y = cell_of(bottom, lower_y_, scale_y_),
                      end_y = cell_of(top, lower_y_, scale_y_) + 1;
  for (std::uint32_t y = begin_y; y < end_y; ++y) {
    const std::uint32_t begin = cell_begin_[y * columns_ + begin_x], end = cell_begin_[y * columns_ + end_x];
    for (std::uint32_t i = begin; i < end; ++i) {
      if (blocks(cell_corners_[i])) {
        tests_left_ -= std::min<std::uint64_t>(tests_left_, i - begin + 1);
        return false;
      }
    }
    tests_left_ -= std::min<std::uint64_t>(tests_left_, end - begin + 1);
  }
  return true;
}

// Cuts off the triangle at the corner, whatever it is.
void Triangulator::cut(std::uint32_t corner) {
  Corner& b = corners_[corner];
  triangles_->push_back({polygon_[b.before], polygon_[corner], polygon_[b.after]});
  b.may_block = false;
  corners_[b.before].after = b.after;
  corners_[b.after].before = b.before;
  --left_;
  for (const std::uint32_t neighbour : {b.before, b.after})
    corners_[neighbour].may_block = turn_at(neighbour) <= 0;
}

// Cuts off the corner if it is a dead end, and what that makes of its neighbours.
void Triangulator::cut_dead_ends(std::uint32_t corner) {
  while (left_ > 3 && is_dead_end(corner)) {
    cut(corner);
    const std::uint32_t before = corners_[corner].before, after = corners_[corner].after;
    corner = is_dead_end(after) ? after : before;
  }
}

void Triangulator::cut_all() {
  // Dead ends first: an ear beside one could lie outside of the polygon.
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    const Corner& corner = corners_[i];
    const bool is_left = corners_[corner.before].after == i && corners_[corner.after].before == i;
    if (is_left) cut_dead_ends(i);
  }
  // What may be cut when nothing else can be: corners on a straight line come last, because neighbours that
  // have them as corners share them only with triangles that have them as well.
  enum { ears, touching_ears, straight_corners, anything } allowed = ears;
  bool crosses = false;
  std::uint32_t i = 0;
  while (corners_[corners_[i].before].after != i) ++i;
  for (std::size_t seen = 0; left_ > 3;) {
    const int t = turn_at(i);
    const bool is_cut = allowed == anything || (t > 0 && is_ear(i, allowed >= touching_ears)) ||
                        (t == 0 && allowed >= straight_corners);
    const std::uint32_t after = corners_[i].after;
    if (is_cut) {
      if (allowed == anything && !crosses) {
        crosses = true;
        tests_left_ = std::min(tests_left_, tests_per_crossing_corner * corners_.size());
      }
      const std::uint32_t before = corners_[i].before;
      cut(i);
      cut_dead_ends(before);
      if (corners_[corners_[after].before].after == after) cut_dead_ends(after);
      allowed = tests_left_ == 0 ? anything : ears;
      seen = 0;
      // The next ear is looked for behind the next corner, so that they are cut all round.
      i = after;
      while (corners_[corners_[i].before].after != i) i = corners_[i].after;
      i = corners_[i].after;
    } else {
      i = after;
      if (++seen >= left_ || tests_left_ == 0) {
        allowed = tests_left_ == 0 ? anything : static_cast<decltype(allowed)>(allowed + 1);
        seen = 0;
      }
    }
  }
  // Of an outline that crosses itself the last triangle may go round the other way.
  crossing_ += crosses || turn_at(i) < 0;
  const Corner& last = corners_[i];
  triangles_->push_back({polygon_[last.before], polygon_[i], polygon_[last.after]});
}

void Triangulator::append(std::span<const kerf::Vec3f> vertices, std::span<const std::uint32_t> polygon,
                          Triangles& triangles) {
  if (polygon.size() == 3) {
    triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return;
  }
  polygon_ = polygon;
  triangles_ = &triangles;
  flatten(vertices, polygon);
  for (const Corner& corner : corners_) {
    if (std::isfinite(corner.x) && std::isfinite(corner.y)) continue;
    for (std::size_t i = 2; i < polygon.size(); ++i)
      triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
    return;  // nothing to decide by; the vertex is named where vertices are checked
  }
  fill_grid();
  left_ = corners_.size();
  tests_left_ = tests_per_corner * corners_.size();
  cut_all();
}

}  // namespace workbench
