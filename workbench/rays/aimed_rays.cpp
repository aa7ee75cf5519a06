#include "workbench/rays/aimed_rays.hpp"

#include <cmath>
#include <random>
#include <utility>

#include "workbench/base/vectors.hpp"
#include "workbench/sampling/angles.hpp"

namespace workbench {

using namespace kerf;

namespace {

// Turned about z and then about x by an angle without symmetries, scaled, and moved.
Solid placed(Solid solid, float scale, Vec3f offset) {
  const auto [s, c] = sine_cosine(0.1117);
  for (Vec3f& v : solid.vertices) {
    v = {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
    v = {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
    v = scale * v + offset;
  }
  return solid;
}

// A sphere with waves up to a third of its radius high, similar to scanned figures, but closed.
Solid make_lumpy_sphere(int level) {
  Solid solid = make_sphere(level);
  for (Vec3f& v : solid.vertices) {
    const float wave = sine_cosine(0.9f * v.x + 0.4f * v.y).sine + sine_cosine(1.3f * v.y - 0.7f * v.z).sine +
                       sine_cosine(2.1f * v.z + 0.3f * v.x).sine;
    v = (1.0f + wave / 9.0f) * v;
  }
  return solid;
}

Solid stretched(Solid solid, float x, float y, float z) {
  for (Vec3f& v : solid.vertices) v = {x * v.x, y * v.y, z * v.z};
  return solid;
}

float uniform(std::mt19937& random, float low, float high) {
  return low + (high - low) * (static_cast<float>(random() >> 8) * 0x1p-24f);
}

// A random point in a box `scale` times as large as `bounds`.
Vec3f random_point(std::mt19937& random, const Box3f& bounds, float scale) {
  Vec3f point;
  for (int axis = 0; axis < 3; ++axis) {
    const float center = 0.5f * bounds.lower[axis] + 0.5f * bounds.upper[axis];
    const float half = scale * (0.5f * bounds.upper[axis] - 0.5f * bounds.lower[axis]);
    point[axis] = uniform(random, center - half, center + half);
  }
  return point;
}

class Aim {
 public:
  Aim(const Solid& solid, const Bvh& bvh, std::uint32_t seed)
      : solid_(solid), bvh_(bvh), bounds_(bvh.bounds()), random_(seed) {
    const Vec3f size = bounds_.upper - bounds_.lower;
    margin_ = 1e-5f * std::max({size.x, size.y, size.z});
  }

  void choose_points() {
    do {
      outside_ = random_point(random_, bounds_, 3.0f);
    } while (bvh_.contains(outside_));
    // A point half way between the first two crossings of a line from outside, unless it is too close to the
    // surface.
    Hit hits[2];
    do {
      const Ray ray{.origin = outside_, .direction = target() - outside_};
      if (bvh_.all_hits(ray, hits) < 2) continue;
      inside_ = ray.origin + 0.5f * (hits[0].t + hits[1].t) * ray.direction;
    } while (!bvh_.contains(inside_) || bvh_.closest_point(inside_, margin_).has_value());
  }

  // A vertex, the middle of an edge or any point of it, as exactly as floats can represent it.
  Vec3f target() {
    const auto& triangle = solid_.triangles[random_() % solid_.triangles.size()];
    const std::size_t corner = random_() % 3;
    const Vec3f a = solid_.vertices[triangle[corner]], b = solid_.vertices[triangle[(corner + 1) % 3]];
    switch (random_() % 3) {
      case 0:
        return a;
      case 1:
        return 0.5f * a + 0.5f * b;
      default:
        const float s = uniform(random_, 0.0f, 1.0f);
        return (1.0f - s) * a + s * b;
    }
  }

  void trace(AimedRayCounts& counts) {
    const Vec3f at = target();
    switch (counts.rays++ % 3) {
      case 0:
        return expect_through({.origin = inside_, .direction = at - inside_}, counts);
      case 1:
        counts.parity_errors += crossings({.origin = outside_, .direction = at - outside_}) % 2;
        return;
      default:
        // The ray starts beyond the target as seen from inside. If the surface is not convex, that may be
        // inside again.
        const Vec3f origin = at + uniform(random_, 0.1f, 2.0f) * (at - inside_);
        const Ray segment{.origin = origin, .direction = inside_ - origin, .t_min = 0.0f, .t_max = 1.0f};
        if (!bvh_.contains(origin)) return expect_through(segment, counts);
        counts.parity_errors += crossings(segment) % 2;
    }
  }

 private:
  std::size_t crossings(const Ray& ray) const { return bvh_.all_hits(ray, std::span<Hit>()); }

  void expect_through(const Ray& ray, AimedRayCounts& counts) const {
    counts.leaks += !bvh_.intersect(ray).has_value() || !bvh_.occluded(ray);
    counts.parity_errors += crossings(ray) % 2 == 0;
  }

  const Solid& solid_;
  const Bvh& bvh_;
  Box3f bounds_;
  float margin_;
  std::mt19937 random_;
  Vec3f inside_ = {std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f}, outside_;
};

}  // namespace

std::vector<NamedSolid> make_watertight_solids() {
  const Solid sphere = make_sphere(6), torus = make_torus(160, 80), lumpy = make_lumpy_sphere(6);
  const Solid box = make_box({-1, -2, -3}, {1, 2, 3}, 24);
  return {
      {"sphere", sphere},
      {"sphere, turned and moved", placed(sphere, 1e3f, {-200, 3000, 70})},
      {"sphere, far from the origin", placed(sphere, 1.0f, {1e3f, -3e3f, 2e3f})},
      {"sphere of 1e-9", placed(make_sphere(5), 1e-9f, {1e-9f, 0, 2e-9f})},
      {"sphere of 1e9", placed(make_sphere(5), 1e9f, {0, 3e9f, 0})},
      {"box", box},
      {"box, turned and moved", placed(box, 7.0f, {100, -30, 20})},
      {"torus", torus},
      {"torus, turned and moved", placed(torus, 0.01f, {-0.2f, 0.1f, 0.3f})},
      {"lumpy sphere", lumpy},
      {"lumpy sphere, turned and moved", placed(lumpy, 30.0f, {400, 500, -600})},
      {"slivers", stretched(make_sphere(4), 1000.0f, 1.0f, 1.0f)},
      {"slivers, turned and moved",
       placed(stretched(make_lumpy_sphere(4), 1.0f, 100.0f, 0.3f), 1.0f, {50, -60, 70})},
      {"a box of twelve long triangles",
       placed(make_box({-500, -0.5f, -2}, {500, 0.5f, 2}), 1.0f, {0, 10, 0})},
  };
}

AimedRayCounts trace_aimed_rays(const Solid& solid, const Bvh& bvh, std::uint64_t count, std::uint32_t seed) {
  constexpr std::uint64_t rays_per_point = 256;  // finding a point takes a few rays
  AimedRayCounts counts;
  Aim aim(solid, bvh, seed);
  while (counts.rays < count) {
    if (counts.rays % rays_per_point == 0) aim.choose_points();
    aim.trace(counts);
  }
  return counts;
}

}  // namespace workbench
