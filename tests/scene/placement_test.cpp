// Rays in the space of an object, against maps in long doubles.
#include "scene/placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/adversarial.hpp"
#include "support/instrumented.hpp"
#include "support/targets.hpp"

namespace kerf {
namespace {

using adversarial::uniform;
using adversarial::uniform_point;

struct Placed {
  Transform transform;
  Box3f bounds;
};

// A turn, a scale along each axis and a shear of an object that may lie far from its own origin.
Placed any_placed(std::mt19937& random) {
  Placed placed;
  do {
    for (auto& row : placed.transform.rows) {
      for (double& x : row) x = uniform(random, -1, 1);
      row[3] *= std::ldexp(1.0, static_cast<int>(random() % 16));
    }
    const float size = std::ldexp(1.0f, static_cast<int>(random() % 8));
    const Vec3f at = uniform_point(random, std::ldexp(1.0f, static_cast<int>(random() % 16)));
    placed.bounds = {at, at + Vec3f{size, uniform(random, 0, 1) * size, uniform(random, 0, 1) * size}};
  } while (!(place_object(placed.transform, placed.bounds).condition < 1000));
  return placed;
}

long double moved(const Transform& transform, int i, const Vec3f& origin, const Vec3f& direction,
                  long double t) {
  long double sum = transform.rows[i][3];
  for (int j = 0; j < 3; ++j)
    sum += transform.rows[i][j] * (static_cast<long double>(origin[j]) + t * direction[j]);
  return sum;
}

// Half a unit in the last place of the origin and of the direction, as docs/algorithms.md has it.
TEST(Placement, ARayIsMovedByNoMoreThanItsRounding) {
  std::mt19937 random(1);
  for (std::size_t i = 0; i < test::reduced(20000); ++i) {
    const auto [transform, bounds] = any_placed(random);
    const auto [placement, condition] = place_object(transform, bounds);
    const Box3f box = place_box(transform, bounds);
    const Vec3f origin = box.lower + uniform_point(random, std::ldexp(1.0f, static_cast<int>(random() % 12)));
    const Ray ray{.origin = origin, .direction = uniform_point(random, 1.0f)};
    const MovedRay local = placement.to_object(ray);
    ASSERT_EQ(local.unit, 1.0);
    long double size = 0, reach = 0;  // of the object from its origin or its corner; of the ray to it
    for (int k = 0; k < 3; ++k) {
      long double sum = 0;
      for (int j = 0; j < 3; ++j) {
        const float corner = std::max(std::abs(bounds.lower[j]), std::abs(bounds.upper[j]));
        sum += std::abs(transform.rows[k][j]) * corner;
      }
      size = std::max(size, sum);
      reach = std::max({reach, std::abs(static_cast<long double>(origin[k]) - box.lower[k]),
                        std::abs(static_cast<long double>(origin[k]) - box.upper[k])});
    }
    const float length =
        std::max({std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z)});
    for (const float part : {0.0f, 0.5f, 1.0f}) {
      const long double t = part * reach / length;
      for (int k = 0; k < 3; ++k) {
        const long double exact = origin[k] + t * ray.direction[k];
        const long double off =
            std::abs(moved(transform, k, local.ray.origin, local.ray.direction, t) - exact);
        ASSERT_LE(off, 0x1.001p-24L * (2 * condition * reach + 2 * size));
      }
    }
  }
}

TEST(Placement, TheConditionIsOneWhereAxesGoToAxes) {
  const Box3f bounds{{-1, -1, -1}, {1, 1, 1}};
  const Transform scaled{{{0, 1e6, 0, 4}, {0, 0, -1e-6, 5}, {3, 0, 0, 6}}};
  EXPECT_NEAR(place_object(scaled, bounds).condition, 1.0, 1e-12);
  const Transform flat{{{1, 0, 0, 0}, {0, 1, 0, 0}, {1, 1, 0, 0}}};
  EXPECT_EQ(place_object(flat, bounds).condition, std::numeric_limits<double>::infinity());
}

TEST(Placement, TheStretchIsThatOfTheWorstDirection) {
  using Matrix = std::array<std::array<double, 3>, 3>;
  const auto product = [](const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 3; ++k) c[i][j] += a[i][k] * b[k][j];
    return c;
  };
  std::mt19937 random(2);
  const auto turn = [&] {
    const double a = uniform(random, 0, 6), b = uniform(random, 0, 6);
    return product({{{std::cos(a), -std::sin(a), 0}, {std::sin(a), std::cos(a), 0}, {0, 0, 1}}},
                   {{{1, 0, 0}, {0, std::cos(b), -std::sin(b)}, {0, std::sin(b), std::cos(b)}}});
  };
  for (int i = 0; i < 200; ++i) {
    const double x = std::exp(uniform(random, -4, 4)), y = i % 3 == 0 ? x : std::exp(uniform(random, -4, 4)),
                 z = i % 5 == 0 ? x : std::exp(uniform(random, -4, 4));
    const Matrix m = product(product(turn(), {{{x, 0, 0}, {0, y, 0}, {0, 0, z}}}), turn());
    Transform transform;
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 3; ++column) transform.rows[row][column] = m[row][column];
    const double expected = 1.0 / std::min({x, y, z});
    const double stretch = place_object(transform, {{-1, -1, -1}, {1, 1, 1}}).placement.largest_stretch();
    EXPECT_GE(stretch, expected);
    EXPECT_LE(stretch, 1.04 * expected);
  }
}

TEST(Placement, ManyAtATimeAreThoseOneByOneToTheBit) {
  std::mt19937 random(4);
  std::vector<Placed> all;
  for (std::size_t i = 0; i < 37; ++i) all.push_back(any_placed(random));
  all.push_back({{{{1, 0, 0, 0}, {0, 1, 0, 0}, {1, 1, 0, 0}}}, {{-1, -1, -1}, {1, 1, 1}}});  // flat
  std::vector<PlacedBox> placed;
  for (const Placed& one : all) placed.push_back({&one.transform, &one.bounds});
  kerf_tests::for_each_target([&](const Target& target) {
    std::vector<Placement> placements(all.size());
    std::vector<Placement*> to;
    for (Placement& placement : placements) to.push_back(&placement);
    std::vector<double> conditions(all.size());
    std::vector<Box3f> boxes(all.size());
    place_objects(target, placed, to.data(), conditions.data());
    place_boxes(target, placed, boxes.data());
    for (std::size_t i = 0; i < all.size(); ++i) {
      const auto [placement, condition] = place_object(all[i].transform, all[i].bounds);
      EXPECT_EQ(conditions[i], condition);
      EXPECT_EQ(boxes[i], place_box(all[i].transform, all[i].bounds));
      if (condition < PlacedObject::max_condition) {
        EXPECT_EQ(std::memcmp(&placements[i], &placement, sizeof placement), 0);
      }
    }
  });
}

}  // namespace
}  // namespace kerf
