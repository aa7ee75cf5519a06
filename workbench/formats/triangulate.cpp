#include "workbench/formats/triangulate.hpp"

#include <cmath>
#include <vector>

namespace workbench {
namespace {

struct Point {
  double x, y;
};

// Twice the signed area: positive if a, b, c turn left.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The polygon projected along the axis nearest to its normal, counter-clockwise. The normal is Newell's: the
// sum of the cross products of neighbours (Sutherland, Sproull & Schumacker 1974).
std::vector<Point> flatten(const Scene& scene, std::span<const std::uint32_t> polygon) {
  double normal[3] = {0, 0, 0};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const kerf::Vec3f &a = scene.vertices[polygon[i]], &b = scene.vertices[polygon[(i + 1) % polygon.size()]];
    normal[0] += (double{a.y} - b.y) * (double{a.z} + b.z);
    normal[1] += (double{a.z} - b.z) * (double{a.x} + b.x);
    normal[2] += (double{a.x} - b.x) * (double{a.y} + b.y);
  }
  int axis = 0;
  for (int i = 1; i < 3; ++i) axis = std::abs(normal[i]) > std::abs(normal[axis]) ? i : axis;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double sign = normal[axis] < 0 ? -1.0 : 1.0;
  std::vector<Point> points;
  points.reserve(polygon.size());
  for (const std::uint32_t vertex : polygon) {
    points.push_back({sign * static_cast<double>(scene.vertices[vertex][u]), scene.vertices[vertex][v]});
  }
  return points;
}

// True if the triangle at corner `i` turns left and contains no other corner of the polygon.
bool is_ear(const std::vector<Point>& points, const std::vector<std::size_t>& ring, std::size_t i) {
  const std::size_t n = ring.size(), before = (i + n - 1) % n, after = (i + 1) % n;
  const Point &a = points[ring[before]], &b = points[ring[i]], &c = points[ring[after]];
  if (turn(a, b, c) <= 0.0) return false;
  for (std::size_t k = 0; k < n; ++k) {
    if (k == before || k == i || k == after) continue;
    const Point& p = points[ring[k]];
    const bool is_corner =
        (p.x == a.x && p.y == a.y) || (p.x == b.x && p.y == b.y) || (p.x == c.x && p.y == c.y);
    if (!is_corner && turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
  }
  return true;
}

}  // namespace

void append_polygon(Scene& scene, std::span<const std::uint32_t> polygon) {
  std::vector<std::size_t> ring;  // the corners that are left, as positions in `polygon`
  if (polygon.size() > 3 && polygon.size() <= max_corners_with_ears) {
    const std::vector<Point> points = flatten(scene, polygon);
    for (std::size_t i = 0; i < polygon.size(); ++i) ring.push_back(i);
    for (std::size_t i = 0, tried = 0; ring.size() > 3 && tried < ring.size(); ++tried) {
      const std::size_t n = ring.size();
      if (is_ear(points, ring, i)) {
        scene.triangles.push_back(
            {polygon[ring[(i + n - 1) % n]], polygon[ring[i]], polygon[ring[(i + 1) % n]]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
        tried = 0;
        i %= ring.size();  // now that of the next corner, so that ears are cut all round
      } else {
        i = (i + 1) % n;
      }
    }
  } else {
    for (std::size_t i = 0; i < polygon.size(); ++i) ring.push_back(i);
  }
  for (std::size_t i = 2; i < ring.size(); ++i) {
    scene.triangles.push_back({polygon[ring[0]], polygon[ring[i - 1]], polygon[ring[i]]});
  }
}

}  // namespace workbench
