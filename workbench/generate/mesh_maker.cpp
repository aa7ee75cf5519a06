#include "workbench/generate/mesh_maker.hpp"

#include <algorithm>
#include <cmath>

#include "workbench/sampling/angles.hpp"

namespace workbench {

using namespace kerf;

void MeshMaker::add_quad(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  const std::uint32_t first = add_vertex(a);
  add_vertex(b);
  add_vertex(c);
  add_vertex(d);
  add_triangle(first, first + 1, first + 2);
  add_triangle(first, first + 2, first + 3);
}

void MeshMaker::add_box(const Vec3f& corner, const Vec3f& x, const Vec3f& y, const Vec3f& z) {
  // Vertex i is `corner` plus x, y and z if bits 0, 1 and 2 of i are set.
  const auto first = static_cast<std::uint32_t>(vertices_.size());
  for (std::uint32_t i = 0; i < 8; ++i) {
    Vec3f p = corner;
    if (i & 1) p = p + x;
    if (i & 2) p = p + y;
    if (i & 4) p = p + z;
    add_vertex(p);
  }
  constexpr std::uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& [a, b, c, d] : faces) {
    add_triangle(first + a, first + b, first + c);
    add_triangle(first + a, first + c, first + d);
  }
}

void MeshMaker::add_box(const Vec3f& lower, const Vec3f& upper) {
  const Vec3f e = upper - lower;
  add_box(lower, {e.x, 0, 0}, {0, e.y, 0}, {0, 0, e.z});
}

void MeshMaker::add_lathe(const Vec3f& foot, std::span<const ProfilePoint> profile, std::uint32_t segments) {
  std::uint32_t ring = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const std::uint32_t previous = ring;
    ring =
        add_ring(foot + Vec3f{0, profile[i].height, 0}, {1, 0, 0}, {0, 0, -1}, segments, profile[i].radius);
    if (i > 0) join_rings(previous, ring, segments);
  }
}

void MeshMaker::add_bar(const Vec3f& from, const Vec3f& to, float radius, std::uint32_t sides) {
  const std::array path{from, to};
  add_tube(path, sides, [&](float) { return radius; });
}

Vec3f MeshMaker::any_normal(const Vec3f& direction) {
  const Vec3f other = std::abs(direction.y) < 0.9f * length(direction) ? Vec3f{0, 1, 0} : Vec3f{1, 0, 0};
  return normalize(cross(direction, other));
}

std::uint32_t MeshMaker::add_ring(const Vec3f& center, const Vec3f& x, const Vec3f& y, std::uint32_t sides,
                                  float radius) {
  const auto first = static_cast<std::uint32_t>(vertices_.size());
  for (std::uint32_t i = 0; i < sides; ++i) {
    const auto [sine, cosine] = sine_cosine(static_cast<double>(i) / sides);
    add_vertex(center + radius * (cosine * x + sine * y));
  }
  return first;
}

void MeshMaker::join_rings(std::uint32_t lower, std::uint32_t upper, std::uint32_t sides) {
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t next = (i + 1) % sides;
    add_triangle(lower + i, lower + next, upper + next);
    add_triangle(lower + i, upper + next, upper + i);
  }
}

std::uint32_t scaled(double count, double factor, std::uint32_t min) {
  return std::max(min, static_cast<std::uint32_t>(std::floor(count * factor + 0.5)));
}

}  // namespace workbench
