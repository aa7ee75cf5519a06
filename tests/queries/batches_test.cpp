// The calls for many questions against the calls for one, wherever questions and answers lie.
#include <array>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "workbench/generate/solids.hpp"

namespace kerf {
namespace {

using namespace adversarial;

constexpr float infinity = std::numeric_limits<float>::infinity();

// Enough for several tasks, and not a multiple of what a task takes.
constexpr std::size_t question_count = 2500;

const Bvh& torus() {
  static const Bvh bvh = build(workbench::make_torus(48, 24).mesh(), spatial_splits_everywhere());
  return bvh;
}

std::vector<Ray> make_rays() {
  std::mt19937 random(1);
  std::vector<Ray> rays(question_count);
  for (Ray& ray : rays) {
    ray.origin = uniform_point(random, 1.5f);
    ray.direction = uniform_point(random, 1.0f);
    ray.t_min = random() % 4 == 0 ? 0.25f : random() % 4 == 0 ? -0.5f : 0.0f;
    ray.t_max = random() % 4 == 0 ? 1.0f : infinity;
  }
  rays[3].direction = {};
  rays[4].origin.x = std::numeric_limits<float>::quiet_NaN();
  return rays;
}

std::vector<Vec3f> make_points() {
  std::mt19937 random(2);
  std::vector<Vec3f> points(question_count);
  for (Vec3f& point : points) point = uniform_point(random, 1.5f);
  points[3].x = std::numeric_limits<float>::quiet_NaN();
  points[4] = {1.4f, 0, 0};  // a vertex
  return points;
}

std::vector<Hit> gather(const Bvh& bvh, const Ray& ray) {
  std::vector<Hit> hits;
  bvh.all_hits(ray, [&](const Hit& hit) { hits.push_back(hit); });
  return hits;
}

template <class T>
void expect_list(const Lists<T>& lists, std::size_t i, const std::vector<T>& expected) {
  ASSERT_TRUE(std::ranges::equal(lists[i], expected)) << "question " << i;
}

// A number of threads for each call, among them more than there are cores.
const BatchOptions some_threads[] = {{.threads = 0}, {.threads = 1}, {.threads = 3}};

TEST(Batches, RaysInManyTasksHitWhatTheyHitOneByOne) {
  const std::vector<Ray> rays = make_rays();
  for (const BatchOptions& options : some_threads) {
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size());
    torus().intersect(rays, hits, options);
    torus().occluded(rays, occluded, options);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(hits[i], torus().intersect(rays[i]).value_or(Hit{})) << i;
      ASSERT_EQ(occluded[i], torus().occluded(rays[i])) << i;
    }
  }
}

TEST(Batches, HitsAreCountedAndListedAsOneByOne) {
  const std::vector<Ray> rays = make_rays();
  for (const BatchOptions& options : some_threads) {
    std::vector<std::uint32_t> counts(rays.size());
    torus().count_hits(rays, counts, options);
    const Lists<Hit> lists = torus().all_hits(rays, options);
    ASSERT_EQ(lists.size(), rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::vector<Hit> expected = gather(torus(), rays[i]);
      ASSERT_EQ(counts[i], expected.size());
      ASSERT_EQ(torus().count_hits(rays[i]), expected.size());
      expect_list(lists, i, expected);
    }
  }
}

TEST(Batches, HitsAreListedIntoTheCallersMemory) {
  const std::vector<Ray> rays = make_rays();
  std::vector<std::uint32_t> counts(rays.size());
  torus().count_hits(rays, counts);
  std::vector<std::size_t> offsets(rays.size() + 1, 0);
  std::inclusive_scan(counts.begin(), counts.end(), offsets.begin() + 1, std::plus<>(), std::size_t{0});
  std::vector<Hit> hits(offsets.back());
  torus().all_hits(rays, offsets, hits);
  const Lists<Hit> lists = torus().all_hits(rays);
  EXPECT_EQ(offsets, lists.offsets);
  EXPECT_EQ(hits, lists.items);

  // Room for two each: the first two, and misses where there are fewer.
  for (std::size_t i = 0; i < offsets.size(); ++i) offsets[i] = 2 * i;
  hits.assign(offsets.back(), Hit{.t = 7, .primitive = 7, .mesh = 7});
  torus().all_hits(rays, offsets, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t k = 0; k < 2; ++k) ASSERT_EQ(hits[2 * i + k], k < lists[i].size() ? lists[i][k] : Hit{});
  }
}

TEST(Batches, PointsAreAnsweredAsOneByOne) {
  const std::vector<Vec3f> points = make_points();
  for (const BatchOptions& options : some_threads) {
    std::vector<SurfacePoint> closest(points.size());
    std::vector<float> distances(points.size());
    std::vector<std::uint8_t> inside(points.size());
    std::vector<Side> sides(points.size());
    torus().closest_point(points, closest, 0.5f, options);
    torus().signed_distance(points, distances, options);
    torus().contains(points, inside, options);
    torus().side(points, sides, options);
    const Lists<SurfacePoint> within = torus().within(points, 0.2f, options);
    const Lists<SurfacePoint> nearest = torus().nearest(points, 3, 0.5f, options);
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(closest[i], torus().closest_point(points[i], 0.5f).value_or(SurfacePoint{}));
      ASSERT_EQ(static_cast<bool>(closest[i]), torus().closest_point(points[i], 0.5f).has_value());
      ASSERT_EQ(distances[i], torus().signed_distance(points[i]));
      ASSERT_EQ(inside[i], torus().contains(points[i]));
      ASSERT_EQ(sides[i], torus().side(points[i]));
      expect_list(within, i, torus().within(points[i], 0.2f));
      expect_list(nearest, i, torus().nearest(points[i], 3, 0.5f));
    }
  }
}

TEST(Batches, BoxesAreAnsweredAsOneByOne) {
  const std::vector<Vec3f> points = make_points();
  std::vector<Box3f> boxes;
  for (const Vec3f& p : points) boxes.push_back({p, {p.x + 0.2f, p.y + 0.1f, p.z + 0.3f}});
  for (const BatchOptions& options : some_threads) {
    const Lists<PrimitiveId> lists = torus().triangles_in(boxes, options);
    for (std::size_t i = 0; i < boxes.size(); ++i) expect_list(lists, i, torus().triangles_in(boxes[i]));
  }
}

TEST(Batches, RaysMayLieInAnyLayout) {
  const std::vector<Ray> rays = make_rays();
  const std::size_t count = rays.size();
  std::vector<Hit> expected(count), unbounded(count);
  torus().intersect(rays, expected);
  std::vector<Ray> whole = rays;
  for (Ray& ray : whole) ray.t_min = 0.0f, ray.t_max = infinity;
  torus().intersect(whole, unbounded);

  std::vector<float> six, columns(8 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const Ray& r = rays[i];
    const float numbers[8] = {r.origin.x,    r.origin.y,    r.origin.z, r.direction.x,
                              r.direction.y, r.direction.z, r.t_min,    r.t_max};
    six.insert(six.end(), numbers, numbers + 6);
    for (std::size_t k = 0; k < 8; ++k) columns[k * count + i] = numbers[k];
  }
  std::vector<Hit> hits(count);
  torus().intersect(RayView::six_floats(six.data(), count), hits);
  EXPECT_EQ(hits, unbounded);

  RayView arrays;
  arrays.count = count;
  for (int axis = 0; axis < 3; ++axis) {
    arrays.origin[axis].data = columns.data() + static_cast<std::size_t>(axis) * count;
    arrays.direction[axis].data = columns.data() + static_cast<std::size_t>(3 + axis) * count;
  }
  arrays.t_min.data = columns.data() + 6 * count;
  arrays.t_max.data = columns.data() + 7 * count;
  torus().intersect(arrays, hits);
  EXPECT_EQ(hits, expected);

  // Eight floats a ray at an odd address, from the last to the first.
  std::vector<std::byte> bytes(32 * count + 1);
  std::memcpy(bytes.data() + 1, rays.data(), 32 * count);
  const auto* last = reinterpret_cast<const float*>(bytes.data() + 1 + 32 * (count - 1));
  RayView backwards;
  backwards.count = count;
  Column<const float>* const parts[] = {
      &backwards.origin[0],    &backwards.origin[1],    &backwards.origin[2], &backwards.direction[0],
      &backwards.direction[1], &backwards.direction[2], &backwards.t_min,     &backwards.t_max};
  for (std::size_t k = 0; k < 8; ++k) *parts[k] = {last + k, -32};
  torus().intersect(backwards, hits);
  std::reverse(hits.begin(), hits.end());
  EXPECT_EQ(hits, expected);

  // One origin of all.
  const Vec3f eye{0, 2, 0};
  std::vector<Vec3f> directions;
  for (Ray& ray : whole) {
    ray.origin = eye;
    directions.push_back(ray.direction);
  }
  torus().intersect(whole, expected);
  torus().intersect(RayView::origins_and_directions(&eye.x, &directions.front().x, count, 0), hits);
  EXPECT_EQ(hits, expected);
}

TEST(Batches, HitsMayGoToAnArrayForEachField) {
  const std::vector<Ray> rays = make_rays();
  std::vector<Hit> expected(rays.size());
  torus().intersect(rays, expected);
  std::vector<float> t(rays.size(), -1.0f);
  std::vector<std::array<std::uint32_t, 3>> ids(rays.size());
  HitView view;
  view.count = rays.size();
  view.t.data = t.data();
  view.primitive = {&ids[0][1], sizeof(ids[0])};
  torus().intersect(rays, view);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(t[i], expected[i].t);
    ASSERT_EQ(ids[i], (std::array<std::uint32_t, 3>{0, expected[i].primitive, 0}));
  }
}

template <class T>
void expect_flags(const std::vector<Ray>& rays, const std::vector<std::uint8_t>& expected) {
  const auto flags = std::make_unique<T[]>(2 * rays.size());
  torus().occluded(rays, std::span(flags.get(), rays.size()));
  for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(flags[i], static_cast<T>(expected[i]));
  torus().occluded(rays, FlagView(flags.get(), rays.size(), 2));
  for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(flags[2 * i], static_cast<T>(expected[i]));
}

TEST(Batches, FlagsMayBeOfAnyTypeOfOneByte) {
  const std::vector<Ray> rays = make_rays();
  std::vector<std::uint8_t> expected(rays.size());
  torus().occluded(rays, expected);
  expect_flags<bool>(rays, expected);
  expect_flags<char>(rays, expected);
  expect_flags<signed char>(rays, expected);
  expect_flags<std::byte>(rays, expected);
  static_assert(!std::is_constructible_v<FlagView, std::vector<bool>&>);
  static_assert(!std::is_constructible_v<FlagView, std::vector<int>&>);
  static_assert(!std::is_constructible_v<FlagView, const std::vector<char>&>);
}

TEST(Batches, AHierarchyOfNothingAnswersEverything) {
  const std::vector<Ray> rays = make_rays();
  const std::vector<Vec3f> points = make_points();
  const Bvh nothing;
  std::vector<Hit> hits(rays.size(), Hit{.t = 1});
  nothing.intersect(rays, hits);
  EXPECT_EQ(hits, std::vector<Hit>(rays.size()));
  std::vector<std::uint32_t> counts(rays.size(), 1);
  nothing.count_hits(rays, counts);
  EXPECT_EQ(counts, std::vector<std::uint32_t>(rays.size(), 0));
  EXPECT_TRUE(nothing.all_hits(rays).items.empty());
  std::vector<SurfacePoint> closest(points.size(), *torus().closest_point({0, 0, 0}));
  nothing.closest_point(points, closest);
  EXPECT_EQ(closest, std::vector<SurfacePoint>(points.size()));
  std::vector<float> distances(points.size());
  nothing.signed_distance(points, distances);
  EXPECT_EQ(distances, std::vector<float>(points.size(), infinity));
  EXPECT_TRUE(nothing.within(points, 1.0f).items.empty());
  EXPECT_TRUE(nothing.nearest(points, 2).items.empty());
}

TEST(Batches, NoQuestionsHaveNoAnswers) {
  std::vector<Hit> hits;
  torus().intersect(std::vector<Ray>(), hits);
  torus().intersect(RayView::six_floats(nullptr, 0), hits);
  EXPECT_EQ(torus().all_hits(RayView()).size(), 0u);
  const std::vector<Vec3f> no_points;
  EXPECT_EQ(torus().within(no_points, 1.0f).size(), 0u);
  EXPECT_EQ(torus().triangles_in(std::span<const Box3f>()).size(), 0u);
}

template <class Call>
void expect_refused(const Call& call) {
  try {
    call();
    ADD_FAILURE() << "taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::invalid_argument) << error.what();
  }
}

TEST(Batches, LengthsThatDifferAreRefused) {
  const std::vector<Ray> rays(3);
  const std::vector<Vec3f> points(3);
  std::vector<Hit> hits(2);
  std::vector<std::uint8_t> flags(2);
  std::vector<std::uint32_t> counts(2);
  std::vector<SurfacePoint> closest(2);
  std::vector<float> distances(2);
  std::vector<Side> sides(2);
  expect_refused([&] { torus().intersect(rays, hits); });
  expect_refused([&] { torus().occluded(rays, flags); });
  expect_refused([&] { torus().count_hits(rays, counts); });
  expect_refused([&] { torus().closest_point(points, closest); });
  expect_refused([&] { torus().signed_distance(points, distances); });
  expect_refused([&] { torus().contains(points, flags); });
  expect_refused([&] { torus().side(points, sides); });
  for (const std::vector<std::size_t>& offsets :
       {std::vector<std::size_t>{0, 1, 2}, {0, 1, 2, 3}, {0, 2, 1, 2}}) {
    expect_refused([&] { torus().all_hits(rays, offsets, hits); });
  }
}

}  // namespace
}  // namespace kerf
