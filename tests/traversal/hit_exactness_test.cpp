// `intersect` and `occluded` against rational arithmetic. Rounding moves the corners of triangles, and moves
// a corner the same way for all triangles that share it. So a triangle must be hit if the ray crosses it at
// more than that distance from its edges, and may be hit if the ray passes it within that distance.
#include <cstdlib>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/parallel.hpp"
#include "math/ray_box.hpp"
#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/exact_oracle.hpp"
#include "support/instrumented.hpp"
#include "support/targets.hpp"

namespace kerf {
namespace {

using namespace adversarial;
using exact::Number;
using exact::Vector;

Number largest(const Vector& a) {
  return std::max({Number(abs(a.x)), Number(abs(a.y)), Number(abs(a.z))});
}
Number square(const Number& a) {
  return a * a;
}

class HitOracle {
 public:
  HitOracle(const Soup& soup, const Box3f& bounds, const Ray& ray)
      : soup_(soup), ray_(ray), origin_(exact::vector(ray.origin)), direction_(exact::vector(ray.direction)) {
    const Number distance = std::max(largest(exact::vector(bounds.lower) - origin_),
                                     largest(exact::vector(bounds.upper) - origin_));
    tolerance_ = Number(RayBoxes::margin_of_distance * 0x1p-24f) * distance;
  }

  // Whether the point of the triangle that `hit` names is where the ray is at t.
  bool may_be_hit(const Hit& hit) const {
    const auto& [a, b, c] = soup_.triangles[hit.primitive];
    const Number t = exact::number(hit.t), u = exact::number(hit.u), v = exact::number(hit.v);
    const Vector at = origin_ + t * direction_;
    const Vector on_triangle =
        Number(1 - u - v) * exact::vector(a) + u * exact::vector(b) + v * exact::vector(c);
    return largest(at - on_triangle) <= tolerance_ && hit.u >= 0.0f && hit.v >= 0.0f &&
           hit.u + hit.v <= 1.000001f && hit.t >= ray_.t_min && hit.t <= ray_.t_max;
  }

  // Whether the ray crosses the triangle within its range and before `t`, clear of all of its edges.
  bool must_be_hit_before(const Triangle& triangle, float t) const {
    const exact::Crossing crossing = exact::cross_line(ray_.origin, ray_.direction, triangle);
    if (crossing.meeting != exact::Meeting::interior) return false;
    const Vector corners[3] = {exact::vector(triangle.v0) - origin_, exact::vector(triangle.v1) - origin_,
                               exact::vector(triangle.v2) - origin_};
    const Number clear = square(2 * tolerance_);
    for (int i = 0; i < 3; ++i) {
      const Vector &a = corners[i], &b = corners[(i + 1) % 3];
      const Vector across = exact::cross(b - a, direction_);
      if (square(exact::dot(direction_, exact::cross(a, b))) < clear * exact::dot(across, across))
        return false;
    }
    // The distance along the ray by which the triangle may have moved.
    const Vector normal = exact::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const Number moved =
        clear * exact::dot(normal, normal) / square(exact::dot(normal, direction_));  // squared, as t
    const auto clearly_before = [&](const Number& first, const Number& second) {
      return first < second && square(second - first) > moved;
    };
    return (!std::isfinite(ray_.t_min) || clearly_before(exact::number(ray_.t_min), crossing.t)) &&
           (!std::isfinite(t) || clearly_before(crossing.t, exact::number(t)));
  }

 private:
  const Soup& soup_;
  const Ray& ray_;
  Vector origin_, direction_;
  Number tolerance_;
};

void expect_exact(const Soup& soup, const Bvh& bvh, const Ray& ray) {
  const auto hit = bvh.intersect(ray);
  ASSERT_EQ(bvh.occluded(ray), hit.has_value());
  const HitOracle oracle(soup, bvh.bounds(), ray);
  ASSERT_TRUE(!hit || oracle.may_be_hit(*hit)) << "triangle that may not be hit";
  const float nearest = hit ? hit->t : ray.t_max;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    ASSERT_FALSE(oracle.must_be_hit_before(soup.triangles[i], nearest)) << "missed triangle " << i;
}

Soup slivers(std::mt19937& random, float thinness) {
  return Soup([&] {
    std::vector<Triangle> triangles;
    while (triangles.size() < 40) {
      const Vec3f a = uniform_point(random, 1.0f), b = uniform_point(random, 1.0f);
      const Vec3f c = a + uniform(random, 0.0f, 1.0f) * (b - a) + uniform_point(random, thinness);
      if (!collinear(a, b, c)) triangles.push_back({a, b, c});
    }
    return triangles;
  }());
}

TEST(HitExactness, HitsWhatMustBeHitAndNothingThatMayNot) {
  std::mt19937 random(1);
  kerf_tests::for_each_target([&](const Target&) {
    for (const float distance : {1e-6f, 1e-3f, 1.0f, 1e3f, 1e6f}) {
      for (const float thinness : {1.0f, 1e-8f}) {
        const Soup triangles = slivers(random, thinness);
        const Bvh bvh = build(triangles.mesh(), spatial_splits_everywhere());
        for (int i = 0; i < 30; ++i) {
          Ray ray = aim(random, triangles.triangles[random() % 40], distance);
          if (ray.direction == Vec3f{}) continue;
          if (i % 4 == 1) ray.t_max = 1.0f;
          if (i % 4 == 2) ray.t_min = 0.5f;
          if (i % 4 == 3) ray.t_min = i % 8 == 3 ? -2.0f : -std::numeric_limits<float>::infinity();
          ASSERT_NO_FATAL_FAILURE(expect_exact(triangles, bvh, ray));
        }
      }
    }
  });
}

TEST(HitExactness, HitsWhatMustBeHitFarFromTheOriginAndAtAnyScale) {
  std::mt19937 random(2);
  struct Place {
    float offset, scale;
  };
  for (const auto& [at, size] :
       {Place{1e4f, 1.0f}, Place{1e7f, 4.0f}, Place{0.0f, 1e-30f}, Place{0.0f, 1e30f}, Place{0.0f, 4e37f}}) {
    const float offset = at, scale = size;  // a lambda cannot capture parts of a structured binding
    const Soup triangles = soup(40, [&] {
      return Vec3f{offset, -offset, offset} + uniform_point(random, scale);
    });
    const Bvh bvh = build(triangles.mesh(), spatial_splits_everywhere());
    for (int i = 0; i < 60; ++i) {
      const Ray ray = aim(random, triangles.triangles[random() % 40], i % 2 ? 1.0f : 0.1f);
      if (ray.direction == Vec3f{} || !is_finite(ray.direction) || !is_finite(ray.origin)) continue;
      ASSERT_NO_FATAL_FAILURE(expect_exact(triangles, bvh, ray));
    }
  }
}

// What `rays` rays of one seed found, at triangles of all sizes from all distances.
struct Findings {
  std::size_t hits = 0, beside = 0, wrong = 0;
  double max_error = 0.0;                   // of a hit's t, in units in the last place
  std::string first;                        // of what was wrong
  std::vector<std::optional<Hit>> answers;  // of the instruction set that is checked, ray by ray

  void expect(bool right, const char* claim, const Ray& ray) {
    if (right) return;
    if (wrong++ == 0) {
      std::ostringstream out;
      out << std::hexfloat << claim << ", origin " << ray.origin.x << ' ' << ray.origin.y << ' '
          << ray.origin.z << ", direction " << ray.direction.x << ' ' << ray.direction.y << ' '
          << ray.direction.z;
      first = out.str();
    }
  }
};

// Rational arithmetic checks the answers of the first instruction set; those of others must be the same.
void trace_against_rationals(std::uint32_t seed, std::size_t rays, bool is_first, Findings& found) {
  std::size_t answered = 0;
  std::mt19937 random(seed);
  constexpr std::size_t per_soup = 64;
  for (std::size_t traced = 0; traced < rays; traced += per_soup) {
    const float size = power_of_ten(random, -6, 6);
    const float offset = random() % 2 ? 0.0f : size * power_of_ten(random, -2, 2);
    const Soup triangles = soup(24, [&] {
      return Vec3f{offset, -offset, offset} + uniform_point(random, size);
    });
    const Bvh bvh = build(triangles.mesh(), spatial_splits_everywhere());
    for (std::size_t i = 0; i < std::min(per_soup, rays - traced); ++i) {
      Ray ray =
          ray_from_beside(random, triangles.triangles[random() % 24], size * power_of_ten(random, -9, 2));
      if (!is_finite(ray.origin) || !is_finite(ray.direction) || ray.direction == Vec3f{}) continue;
      if (i % 4 == 3) ray.t_min = -std::numeric_limits<float>::infinity();
      const auto hit = bvh.intersect(ray);
      if (!is_first) {
        found.expect(hit == found.answers.at(answered++), "another instruction set has another hit", ray);
        continue;
      }
      found.answers.push_back(hit);
      if (i % 16 == 0) {  // the dearest check
        const HitOracle oracle(triangles, bvh.bounds(), ray);
        bool missed = false;
        for (const Triangle& triangle : triangles.triangles)
          missed = missed || oracle.must_be_hit_before(triangle, hit ? hit->t : ray.t_max);
        found.expect(!missed, "a triangle was missed", ray);
      }
      if (!hit) continue;
      ++found.hits;
      const Triangle& triangle = triangles.triangles[hit->primitive];
      const exact::Crossing truth = exact::cross_line(ray.origin, ray.direction, triangle);
      if (truth.meeting == exact::Meeting::none) {  // it passes the edge by less than corners were rounded
        ++found.beside;
        found.expect(HitOracle(triangles, bvh.bounds(), ray).may_be_hit(*hit), "the hit is too far beside",
                     ray);
        continue;
      }
      const double error = exact::error_in_ulps(hit->t, truth.t);
      found.max_error = std::max(found.max_error, error);
      found.expect(error <= 1.0, "t is not the exact one rounded", ray);
      found.expect((hit->t < 0.0f) == (truth.t < 0), "the hit is on the other side of the origin", ray);
    }
  }
}

// KERF_RAYS=10000000 is the longer run of CONTRIBUTING.md.
TEST(HitExactness, TIsTheExactOneRoundedOnEveryInstructionSet) {
  const char* const wanted = std::getenv("KERF_RAYS");
  const std::size_t rays = wanted ? std::strtoull(wanted, nullptr, 10) : test::reduced(16384);
  constexpr std::uint32_t seeds = 64;
  std::vector<Findings> found(seeds);
  std::string checked;  // the instruction sets so far
  kerf_tests::for_each_target([&](const Target& target) {
    parallel_for(seeds, [&](std::uint32_t seed) {
      trace_against_rationals(seed, rays / seeds, checked.empty(), found[seed]);
    });
    for (const Findings& some : found) EXPECT_EQ(some.wrong, 0u) << some.first;
    checked += ' ' + std::string(target.name);
  });
  Findings all;
  for (const Findings& some : found) {
    all.hits += some.hits;
    all.beside += some.beside;
    all.max_error = std::max(all.max_error, some.max_error);
  }
  EXPECT_GT(all.hits, rays / 2);
  EXPECT_LT(all.beside, all.hits / 100);
  if (wanted) {
    std::cout << rays << " rays, the same hits with" << checked << ": " << all.hits << " hits, t at most "
              << all.max_error << " ulp off, " << all.beside << " beside an edge\n";
  }
}

}  // namespace
}  // namespace kerf
