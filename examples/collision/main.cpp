// Two parts that are pushed together: at which step they touch first, and where.
#include <cstdio>
#include <vector>

#include <kerf/kerf.hpp>

#include "../common/picture.hpp"
#include "../common/shapes.hpp"

int main() {
  const shapes::Mesh ring = shapes::make_ring();
  const kerf::Bvh fixed = kerf::build({.vertices = ring.vertices, .triangles = ring.triangles});
  const kerf::Bvh moved = fixed;  // the same shape; copies share the hierarchy

  kerf::Transform transform{{{1, 0, 0, 4}, {0, 1, 0, 0.35}, {0, 0, 1, 0.1}}};
  double& x = transform.rows[0][3];  // the translation stands in the last column
  int step = 0;
  for (; step < 400; ++step) {
    x = 4.0 - 0.01 * step;
    if (fixed.touches(moved, transform)) break;
  }
  const std::vector<kerf::TouchingPair> pairs = fixed.touching_pairs(moved, transform);
  std::printf("they touch at step %d, x = %.2f: %zu pairs of triangles\n", step, x, pairs.size());

  // Deeper, and from above: one part blue, the other red, triangles that touch white.
  x -= 0.35;
  const auto offset = static_cast<float>(x);
  Picture picture(320, 200);
  std::vector<bool> touching(ring.triangles.size());
  for (const kerf::TouchingPair& pair : fixed.touching_pairs(moved, transform))
    touching[pair.first.primitive] = true;
  for (std::size_t row = 0; row < picture.height; ++row) {
    for (std::size_t column = 0; column < picture.width; ++column) {
      const float px = 0.0165f * (static_cast<float>(column) - 80.0f),
                  py = 0.0165f * (99.5f - static_cast<float>(row));
      const auto a = fixed.intersect({.origin = {px, py, 2}, .direction = {0, 0, -1}});
      const auto b = moved.intersect({.origin = {px - offset, py - 0.35f, 1.9f}, .direction = {0, 0, -1}});
      const float shade_a = a ? 1.0f - 0.35f * (a->t - 1.0f) : 0.0f,
                  shade_b = b ? 1.0f - 0.35f * (b->t - 1.0f) : 0.0f;
      if (a && (!b || a->t < b->t)) {
        touching[a->primitive] ? picture.set(column, row, 1, 1, 1)
                               : picture.set(column, row, 0.1f * shade_a, 0.3f * shade_a, 0.7f * shade_a);
      } else if (b) {
        picture.set(column, row, 0.7f * shade_b, 0.2f * shade_b, 0.1f * shade_b);
      } else {
        picture.set(column, row, 0.02f, 0.02f, 0.03f);
      }
    }
  }
  return picture.save("collision.ppm") ? 0 : 1;
}
