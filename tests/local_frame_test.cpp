#include "local_frame.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/convert.hpp>
#include <kerf/kerf.hpp>

#include "support/targets.hpp"
#include "support/temporary_directory.hpp"

namespace kerf {
namespace {

using Point = std::array<double, 3>;
using LongFace = std::array<std::int64_t, 3>;

struct Survey {
  std::vector<Point> vertices;
  std::vector<LongFace> triangles;
  DoubleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
};

// A floor of n * n cells, 10 cm each, with waves in it.
Survey grid(int n, const Point& at) {
  Survey survey;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      survey.vertices.push_back({at[0] + 0.1 * x, at[1] + 0.1 * y, at[2] + 0.05 * ((x * 7 + y * 3) % 5)});
    }
  }
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const std::int64_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      survey.triangles.push_back({a, b, d});
      survey.triangles.push_back({a, d, c});
    }
  }
  return survey;
}

const Point surveyed{500000.3, 4649776.7, 812.25};  // UTM

TEST(LocalFrame, AGridOfTenCentimetresAnswersFarAwayAsNearTheOrigin) {
  constexpr int n = 60;
  const Survey near = grid(n, {0, 0, 0}), far = grid(n, surveyed);
  kerf_tests::for_each_target([&](const Target&) {
    const Bvh near_bvh = build(near.mesh()), far_bvh = build(far.mesh());
    EXPECT_EQ(near_bvh.origin(), Vec3d{});
    EXPECT_EQ(far_bvh.statistics().degenerate_triangles, 0u);
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        const Point cell{0.1 * x + 0.06, 0.1 * y + 0.03, 3.0};
        const DoubleRay down{.origin = to_vec3d(cell), .direction = {0, 0, -2}};
        const DoubleRay far_down{
            .origin = {surveyed[0] + cell[0], surveyed[1] + cell[1], surveyed[2] + cell[2]},
            .direction = {0, 0, -2}};
        const auto hit = near_bvh.intersect(near_bvh.to_local(down));
        const auto far_hit = far_bvh.intersect(far_bvh.to_local(far_down));
        ASSERT_TRUE(hit && far_hit);
        EXPECT_EQ(hit->primitive, far_hit->primitive);
        EXPECT_NEAR(hit->t, far_hit->t, 2e-6);
        EXPECT_EQ(far_hit->primitive, 2u * static_cast<unsigned>(y * n + x));
      }
    }
  });
}

TEST(LocalFrame, VerticesAreRoundedOnceAsDistancesFromTheOrigin) {
  const Survey far = grid(20, surveyed);
  const DoubleMesh mesh = far.mesh();
  const LocalFrame frame(std::span(&mesh, 1), NonFinite::refuse);
  const Vec3d& o = frame.origin();
  for (std::size_t i = 0; i < far.vertices.size(); ++i) {
    const auto local = frame.meshes()[0].vertices[i];
    const long double origin[3] = {o.x, o.y, o.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const long double distance = far.vertices[i][axis] - origin[axis];  // exact: 64 bits hold it
      EXPECT_EQ(local.values[axis], static_cast<float>(distance));
      EXPECT_LT(std::abs(distance), 2.0L);
    }
  }
}

TEST(LocalFrame, TheOriginIsZeroWhereFloatsLoseNothing) {
  const Survey at_whole_places = [] {
    Survey survey = grid(4, {0, 0, 0});
    for (Point& p : survey.vertices) p = {500000 + std::round(10 * p[0]), 4649776, std::round(10 * p[1])};
    return survey;
  }();
  const Bvh bvh = build(at_whole_places.mesh());
  EXPECT_EQ(bvh.origin(), Vec3d{});
  EXPECT_EQ(bvh.bounds().lower, (Vec3f{500000, 4649776, 0}));
}

TEST(LocalFrame, DoublesAndLongIndicesInBracesAreADoubleMesh) {
  const Survey far = grid(4, surveyed);
  const Bvh bvh = build({.vertices = far.vertices, .triangles = far.triangles});
  EXPECT_NE(bvh.origin(), Vec3d{});
  const std::vector<std::array<float, 3>> floats{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<unsigned> indices{0, 1, 2};
  EXPECT_EQ(build({.vertices = floats, .triangles = indices}).statistics().references, 1u);
  EXPECT_EQ(build({.vertices = {floats.data(), 3, 12}, .triangles = indices}).statistics().references, 1u);
  const std::vector<double> flat{0.1, 0, 0, 1, 0, 0, 0, 1, 0};
  EXPECT_EQ(build({.vertices = flat, .triangles = indices}).statistics().references, 1u);
}

TEST(LocalFrame, PointsGoThereAndBack) {
  const Bvh bvh = build(grid(20, surveyed).mesh());
  const Vec3d place{surveyed[0] + 0.75, surveyed[1] + 1.25, surveyed[2] + 0.5};
  const auto near = bvh.closest_point(bvh.to_local(place));
  ASSERT_TRUE(near);
  const Vec3d found = bvh.from_local(near->position);
  EXPECT_NEAR(found.x, place.x, 0.2);
  EXPECT_NEAR(found.y, place.y, 0.2);
  EXPECT_NEAR(std::hypot(found.x - place.x, found.y - place.y, found.z - place.z), near->distance, 1e-6);
  const DoubleRay ray{.origin = place, .direction = {0, 0, -1}, .t_min = 0.25, .t_max = 8};
  const Ray local = bvh.to_local(ray);
  EXPECT_EQ(local.origin, bvh.to_local(place));
  EXPECT_EQ(local.direction, (Vec3f{0, 0, -1}));
  EXPECT_EQ(local.t_min, 0.25f);
  EXPECT_EQ(local.t_max, 8.0f);
}

TEST(LocalFrame, SeveralMeshesShareOneOrigin) {
  const Survey a = grid(5, surveyed), b = grid(5, {surveyed[0] + 100, surveyed[1], surveyed[2]});
  const std::vector<DoubleMesh> meshes{a.mesh(), {}, b.mesh()};
  const Bvh bvh = build(meshes);
  const auto hit = bvh.intersect(bvh.to_local(DoubleRay{
      .origin = {surveyed[0] + 100.06, surveyed[1] + 0.03, surveyed[2] + 9}, .direction = {0, 0, -1}}));
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->mesh, 2u);
  EXPECT_EQ(hit->primitive, 0u);
}

// A needle whose corners are in one line to floats, one that is so thin that doubles do not tell, and one
// that has no area at all.
TEST(LocalFrame, TrianglesThatLoseTheirAreaByRoundingAreCounted) {
  const double x = surveyed[0], y = surveyed[1];
  Survey survey = grid(10, surveyed);
  const auto add = [&](const Point& a, const Point& b, const Point& c) {
    const auto first = static_cast<std::int64_t>(survey.vertices.size());
    survey.vertices.insert(survey.vertices.end(), {a, b, c});
    survey.triangles.push_back({first, first + 1, first + 2});
  };
  const double ulp = std::nextafter(y, 2 * y) - y;  // floats tell 2^-24 apart here, doubles 2^-30
  add({x, y, 812}, {x, y + 4 * ulp, 812}, {x + 4 * ulp, y, 812});
  add({x, y, 812}, {x + 0.5, y, 812}, {x + 0.25, y + ulp, 812});
  add({x, y, 812}, {x + 0.5, y, 812}, {x + 0.25, y, 812});
  const Bvh bvh = build(survey.mesh());
  EXPECT_EQ(bvh.statistics().degenerate_triangles, 3u);
  EXPECT_EQ(bvh.statistics().degenerate_by_rounding, 2u);
}

TEST(LocalFrame, AnUnusedVertexDoesNotMoveTheOrigin) {
  Survey survey = grid(10, surveyed);
  const Vec3d before = build(survey.mesh()).origin();
  survey.vertices.push_back({0, 0, 0});
  survey.vertices.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  EXPECT_EQ(build(survey.mesh()).origin(), before);
}

TEST(LocalFrame, WhatIsWrongIsNamedOrSkipped) {
  const auto error_of = [](const Survey& survey, NonFinite non_finite = NonFinite::refuse) -> std::string {
    try {
      (void)build(survey.mesh(), {.non_finite = non_finite});
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  Survey survey = grid(10, surveyed);
  survey.triangles[7][1] = (std::int64_t{1} << 32) + 1;  // 1, if its upper half were lost
  EXPECT_NE(error_of(survey).find("triangle 7 of mesh 0 names vertex 4294967297"), std::string::npos);
  EXPECT_EQ(error_of(survey, NonFinite::skip), error_of(survey));
  survey = grid(10, surveyed);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e300}) {
    survey.vertices[0][2] = bad;  // of two triangles
    EXPECT_NE(error_of(survey).find("vertex 0 of mesh 0, used by triangle 0"), std::string::npos);
    const Bvh bvh = build(survey.mesh(), {.non_finite = NonFinite::skip});
    EXPECT_EQ(bvh.statistics().non_finite_triangles, 2u);
    EXPECT_EQ(bvh.statistics().degenerate_triangles, 0u);
    EXPECT_NE(bvh.origin(), Vec3d{});
  }
}

TEST(LocalFrame, NothingHasTheOriginZero) {
  EXPECT_EQ(build(DoubleMesh{}).origin(), Vec3d{});
  EXPECT_EQ(build(std::span<const DoubleMesh>()).origin(), Vec3d{});
  EXPECT_EQ(Bvh().origin(), Vec3d{});
}

TEST(LocalFrame, TheOriginIsSavedAndLoaded) {
  Survey survey = grid(10, surveyed);
  survey.vertices[0][2] = std::numeric_limits<double>::infinity();
  survey.triangles.push_back({1, 1, 1});
  const Bvh bvh = build(survey.mesh(), {.non_finite = NonFinite::skip});
  const TemporaryDirectory directory;
  const auto path = directory / "survey.kerf";
  bvh.save(path);
  for (const Bvh& loaded : {Bvh::load(path), Bvh::map(path)}) {
    EXPECT_EQ(loaded.origin(), bvh.origin());
    EXPECT_EQ(loaded.statistics().non_finite_triangles, 2u);
    EXPECT_EQ(loaded.statistics().degenerate_triangles, 1u);
    EXPECT_EQ(loaded.statistics().degenerate_by_rounding, 0u);
  }
}

}  // namespace
}  // namespace kerf
