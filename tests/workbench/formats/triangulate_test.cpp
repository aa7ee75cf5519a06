#include "workbench/formats/triangulate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace workbench {
namespace {

using kerf::Vec3f;

struct Cut {
  std::vector<Vec3f> vertices;
  Triangulator::Triangles triangles;
  std::size_t crossing = 0;
};

Cut cut(std::vector<Vec3f> outline) {
  std::vector<std::uint32_t> polygon(outline.size());
  std::iota(polygon.begin(), polygon.end(), 0u);
  Cut result{std::move(outline), {}, 0};
  Triangulator triangulator;
  triangulator.append(result.vertices, polygon, result.triangles);
  result.crossing = triangulator.crossing();
  return result;
}

// Twice the area of a triangle seen along z, positive if it goes round like its outline.
double doubled_area(const Cut& cut, std::size_t triangle) {
  const auto& [a, b, c] = cut.triangles[triangle];
  const Vec3f &p = cut.vertices[a], &q = cut.vertices[b], &r = cut.vertices[c];
  return (double{q.x} - p.x) * (double{r.y} - p.y) - (double{q.y} - p.y) * (double{r.x} - p.x);
}

double doubled_area(const std::vector<Vec3f>& outline) {
  double area = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec3f &p = outline[i], &q = outline[(i + 1) % outline.size()];
    area += double{p.x} * q.y - double{p.y} * q.x;
  }
  return area;
}

// Triangles that all go round like the outline, and have its area together, cover it and overlap nowhere.
void expect_covered(const std::vector<Vec3f>& outline, double tolerance = 0.0) {
  const Cut result = cut(outline);
  ASSERT_EQ(result.triangles.size(), outline.size() - 2);
  EXPECT_EQ(result.crossing, 0u);
  double area = 0;
  for (std::size_t i = 0; i < result.triangles.size(); ++i) {
    EXPECT_GE(doubled_area(result, i), 0.0);
    area += doubled_area(result, i);
  }
  EXPECT_NEAR(area, doubled_area(outline), tolerance);
}

std::size_t degenerate(const Cut& cut) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < cut.triangles.size(); ++i) count += doubled_area(cut, i) == 0.0;
  return count;
}

TEST(Triangulate, CoversConcaveOutlines) {
  expect_covered({{2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, 0}, {2, 0, 0}});  // an L
  expect_covered(
      {{0, 0, 0}, {7, 0, 0}, {7, 6, 0}, {5, 6, 0}, {5, 1, 0}, {2, 1, 0}, {2, 6, 0}, {0, 6, 0}});  // a U
  expect_covered({{0, 0, 0}, {3, -2, 0}, {1, 0, 0}, {3, 2, 0}});                                  // a dart
}

TEST(Triangulate, GivesTrianglesWithAnAreaToCornersOnAStraightLine) {
  std::vector<Vec3f> outline;
  for (int i = 0; i < 30; ++i) outline.push_back({static_cast<float>(i), 0, 0});
  for (int i = 0; i < 30; ++i) outline.push_back({30, static_cast<float>(i), 0});
  outline.insert(outline.end(), {{30, 30, 0}, {0, 30, 0}});
  expect_covered(outline);
  EXPECT_EQ(degenerate(cut(outline)), 0u);
}

TEST(Triangulate, GoesAroundHolesThatABridgeLeadsTo) {
  const std::vector<Vec3f> square_in_square = {{0, 0, 0}, {9, 0, 0}, {9, 9, 0}, {0, 9, 0}, {0, 0, 0},
                                               {3, 3, 0}, {3, 6, 0}, {6, 6, 0}, {6, 3, 0}, {3, 3, 0}};
  expect_covered(square_in_square);
  // Two holes, one behind the other, with bridges on one line.
  expect_covered({{0, 0, 0},
                  {12, 0, 0},
                  {12, 4, 0},
                  {0, 4, 0},
                  {0, 2, 0},
                  {2, 2, 0},
                  {3, 3, 0},
                  {4, 2, 0},
                  {7, 2, 0},
                  {8, 3, 0},
                  {9, 2, 0},
                  {8, 1, 0},
                  {7, 2, 0},
                  {4, 2, 0},
                  {3, 1, 0},
                  {2, 2, 0},
                  {0, 2, 0}});
}

TEST(Triangulate, CoversNothingAtRepeatedCornersAndSpikes) {
  expect_covered({{0, 0, 0}, {4, 0, 0}, {4, 0, 0}, {4, 3, 0}, {4, 3, 0}, {4, 3, 0}, {0, 3, 0}, {0, 0, 0}});
  expect_covered({{0, 0, 0}, {4, 0, 0}, {9, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}});  // outward
  expect_covered({{0, 0, 0}, {4, 0, 0}, {2, 1, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}});  // inward
  expect_covered(
      {{0, 0, 0}, {4, 0, 0}, {7, 1, 0}, {9, 5, 0}, {7, 1, 0}, {4, 0, 0}, {4, 3, 0}});  // with a bend
  const Cut line = cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}});
  EXPECT_EQ(line.triangles.size(), 2u);
  EXPECT_EQ(degenerate(line), 2u);
}

// The outline of rooms and of the walls between them: rooms are squares of a grid, connected by doors as a
// tree. It passes walls on both sides, goes to the free ends of walls and back, and meets itself at corners.
std::vector<Vec3f> maze(int size, int rooms, std::mt19937& random) {
  constexpr std::pair<int, int> directions[] = {
      {0, -1}, {1, 0}, {0, 1}, {-1, 0}};  // of a room's sides, in its order
  const auto number = [&](int x, int y) { return static_cast<std::size_t>(y * size + x); };
  std::vector<std::array<bool, 4>> doors(static_cast<std::size_t>(size * size));
  std::vector<bool> is_room(doors.size());
  std::vector<std::pair<int, int>> found = {{size / 2, size / 2}};
  is_room[number(size / 2, size / 2)] = true;
  for (int tries = 0; static_cast<int>(found.size()) < rooms && tries < 100'000; ++tries) {
    const auto [x, y] = found[random() % found.size()];
    const std::size_t side = random() % 4;
    const int to_x = x + directions[side].first, to_y = y + directions[side].second;
    if (to_x < 0 || to_y < 0 || to_x >= size || to_y >= size || is_room[number(to_x, to_y)]) continue;
    is_room[number(to_x, to_y)] = true;
    doors[number(x, y)][side] = doors[number(to_x, to_y)][(side + 2) % 4] = true;
    found.emplace_back(to_x, to_y);
  }
  // With the wall to the right: counter-clockwise round all rooms.
  constexpr std::pair<int, int> corners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};  // where each side begins
  std::vector<Vec3f> outline;
  int x = size / 2, y = size / 2;
  std::size_t side = 0;
  do {
    if (doors[number(x, y)][side]) {
      x += directions[side].first;
      y += directions[side].second;
      side = (side + 3) % 4;
    } else {
      outline.push_back(
          {static_cast<float>(x + corners[side].first), static_cast<float>(y + corners[side].second), 0});
      side = (side + 1) % 4;
    }
  } while (!(x == size / 2 && y == size / 2 && side == 0));
  return outline;
}

TEST(Triangulate, CoversEveryRoomOfAMazeOnce) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    std::vector<Vec3f> outline = maze(2 + i % 9, 2 + i % 40, random);
    ASSERT_GE(outline.size(), 4u);
    if (i % 3 != 0) {  // along no axis
      for (Vec3f& p : outline) p = {3 * p.x + p.y, 2 * p.y - p.x, 0};
    }
    std::rotate(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(random() % outline.size()),
                outline.end());
    expect_covered(outline);
    if (HasFailure()) return;
  }
}

TEST(Triangulate, CoversStarsOfAnyPoints) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> radius(0.1f, 1.0f);
  for (const std::size_t corners : {4u, 5u, 9u, 30u, 100u, 400u}) {
    for (int i = 0; i < 20; ++i) {
      std::vector<Vec3f> outline;
      for (std::size_t k = 0; k < corners; ++k) {
        const double angle = 6.283185307179586 * static_cast<double>(k) / static_cast<double>(corners),
                     r = radius(random);
        outline.push_back(
            {static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)), 0});
      }
      expect_covered(outline, 1e-12);
    }
  }
}

TEST(Triangulate, CoversLongOutlines) {
  // A comb of 3000 teeth.
  std::vector<Vec3f> comb = {{6000, -1, 0}};
  for (int i = 3000; i-- > 0;) {
    comb.push_back({static_cast<float>(2 * i + 1), 50, 0});
    comb.push_back({static_cast<float>(2 * i), static_cast<float>(i % 7), 0});
  }
  comb.push_back({0, -1, 0});
  expect_covered(comb);
}

TEST(Triangulate, KeepsTheSideThatAPolygonShows) {
  for (const int axis : {0, 1, 2}) {
    for (const bool turned : {false, true}) {
      std::vector<Vec3f> outline = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 1, 0}, {0, 4, 0}};
      if (turned) std::reverse(outline.begin(), outline.end());
      for (Vec3f& p : outline) {
        for (int i = 0; i < axis; ++i) p = {p.z, p.x, p.y};
      }
      const Cut result = cut(outline);
      ASSERT_EQ(result.triangles.size(), 3u);
      for (const auto& [a, b, c] : result.triangles) {
        const Vec3f &p = outline[a], &q = outline[b], &r = outline[c];
        const float normal[3] = {(q.y - p.y) * (r.z - p.z) - (q.z - p.z) * (r.y - p.y),
                                 (q.z - p.z) * (r.x - p.x) - (q.x - p.x) * (r.z - p.z),
                                 (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)};
        EXPECT_EQ(normal[(axis + 2) % 3] > 0, !turned);
      }
    }
  }
}

TEST(Triangulate, ReturnsFromOutlinesThatCrossThemselves) {
  EXPECT_EQ(cut({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 1, 0}}).crossing, 1u);
  std::mt19937 random(3);
  for (const int corners : {5, 50, 500, 20'000}) {
    std::vector<Vec3f> scribble, zigzag;  // the last side of a zigzag crosses all others
    for (int i = 0; i < corners; ++i) {
      scribble.push_back({static_cast<float>(random() % 1000), static_cast<float>(random() % 1000), 0});
      zigzag.push_back({static_cast<float>(i % 2), static_cast<float>(i), 0});
    }
    EXPECT_EQ(cut(scribble).triangles.size(), scribble.size() - 2);
    EXPECT_EQ(cut(zigzag).triangles.size(), zigzag.size() - 2);
  }
}

}  // namespace
}  // namespace workbench
