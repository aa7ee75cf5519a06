#include "workbench/scene/viewpoints.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <kerf/build.hpp>
#include <kerf/inspect.hpp>

#include "workbench/base/vectors.hpp"
#include "workbench/sampling/angles.hpp"

namespace workbench {
namespace {

using namespace kerf;

/// So many triangles distinguish open places from closed ones, and the hierarchy over them is built quickly.
constexpr std::size_t sample_size = 100'000;

/// Where so much lies over one another that the rays would test more triangles than this, in half a second, a
/// tenth of the sample distinguishes them as well.
constexpr std::size_t max_tests = 10'000'000;

/// Of scenes of many places so many triangles stand for all of them where views are sought.
constexpr std::size_t shape_size = 4'000'000;

/// From each place rays go in directions 22.5 degrees apart, with three slopes each.
constexpr int directions = 16;
constexpr float slopes[] = {-0.45f, -0.15f, 0.15f};
constexpr int half_view = 2;  // number of directions on either side of the middle of a picture

struct Candidate {
  Viewpoint viewpoint;
  float openness;
};

Vec3f vertex(const TriangleMesh& mesh, std::uint32_t i) {
  const auto [x, y, z] = mesh.vertices[i].values;
  return {x, y, z};
}

Box3f bounds_of(const TriangleMesh& mesh) {
  Box3f bounds;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t index : mesh.triangles[i].values) bounds = merge(bounds, vertex(mesh, index));
  }
  return bounds;
}

TriangleMesh sample_of(const TriangleMesh& mesh, std::size_t size) {
  TriangleMesh sample = mesh;
  const std::size_t step = 1 + (mesh.triangles.size() - 1) / size;
  sample.triangles = {mesh.triangles.data(), (mesh.triangles.size() + step - 1) / step,
                      step * mesh.triangles.stride()};
  return sample;
}

// The distance of the hit of `ray`, or 0 if there is none. A hit on the back of a surface counts for little:
// a place from which many backs are visible lies in a solid.
float visible_distance(const TriangleMesh& sample, const Bvh& bvh, const Ray& ray, TraversalCounters& work) {
  constexpr float weight_of_backs = 0.1f;
  const auto hit = intersect(bvh, ray, work);
  if (!hit) return 0.0f;
  const auto [a, b, c] = sample.triangles[hit->primitive].values;
  const Vec3f v0 = vertex(sample, a), normal = cross(vertex(sample, b) - v0, vertex(sample, c) - v0);
  return dot(normal, ray.direction) > 0.0f ? weight_of_backs * hit->t : hit->t;
}

// Chooses the direction in which the contents of a whole picture are farthest away, but not missing.
Candidate look_around(const TriangleMesh& sample, const Bvh& bvh, const Vec3f& position, float diagonal,
                      TraversalCounters& work) {
  std::array<float, directions> far{};
  float nearest = diagonal;
  for (int i = 0; i < directions; ++i) {
    const auto [sine, cosine] = sine_cosine(static_cast<double>(i) / directions);
    for (const float slope : slopes) {
      const float t = visible_distance(
          sample, bvh, {.origin = position, .direction = normalize({cosine, slope, sine})}, work);
      far[static_cast<std::size_t>(i)] += t;
      if (t > 0.0f) nearest = std::min(nearest, t);
    }
  }
  Candidate best{.viewpoint = {.position = position, .target = position + Vec3f{0, 0, -diagonal}},
                 .openness = 0};
  for (int i = 0; i < directions; ++i) {
    float sum = 0.0f;
    for (int k = -half_view; k <= half_view; ++k) {
      sum += far[static_cast<std::size_t>((i + k + directions) % directions)];
    }
    if (sum <= best.openness) continue;
    const auto [sine, cosine] = sine_cosine(static_cast<double>(i) / directions);
    best.viewpoint.target = position + diagonal * Vec3f{cosine, slopes[1], sine};
    best.openness = sum;
  }
  // A wall close by would fill the picture.
  best.openness *= std::min(1.0f, nearest / (0.03f * diagonal));
  return best;
}

std::vector<Viewpoint> choose_inside(const TriangleMesh& mesh, const Box3f& bounds, float diagonal,
                                     std::size_t size = sample_size) {
  const TriangleMesh sample = sample_of(mesh, size);
  TraversalCounters work;
  const Bvh bvh = build(sample, {.builder = Builder::bvh, .progress = {}});
  std::vector<Candidate> candidates;
  for (const float y : {0.25f, 0.5f, 0.7f}) {
    for (const float x : {0.12f, 0.3f, 0.5f, 0.7f, 0.88f}) {
      for (const float z : {0.12f, 0.3f, 0.5f, 0.7f, 0.88f}) {
        const Vec3f e = extent(bounds);
        candidates.push_back(
            look_around(sample, bvh, bounds.lower + Vec3f{x * e.x, y * e.y, z * e.z}, diagonal, work));
        if (work.triangle_tests > max_tests && size > 1)
          return choose_inside(mesh, bounds, diagonal, size / 10);
      }
    }
  }
  // First the most open place, then twice a place that is open and far from those chosen before.
  std::vector<Viewpoint> chosen;
  while (chosen.size() < 3) {
    const auto worth = [&](const Candidate& candidate) {
      float distance = 0.25f * diagonal;
      for (const Viewpoint& other : chosen) {
        distance = std::min(distance, length(other.position - candidate.viewpoint.position));
      }
      return candidate.openness * distance;
    };
    const auto best = std::max_element(candidates.begin(), candidates.end(),
                                       [&](const auto& a, const auto& b) { return worth(a) < worth(b); });
    chosen.push_back(best->viewpoint);
  }
  return chosen;
}

// A sphere around the mesh.
struct Ball {
  Vec3f center;
  float radius;
};

Ball ball_around(const Box3f& bounds) {
  const Vec3f center = 0.5f * bounds.lower + 0.5f * bounds.upper;
  const float far_from_origin = std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)});
  // A mesh without extent is viewed from a distance that is not rounded away.
  const float radius = std::max(0.5f * length(extent(bounds)), 1e-5f * far_from_origin);
  return {center, radius == 0.0f ? 1.0f : radius};
}

// From as near as possible for a picture of `aspect` to show all vertices.
Viewpoint look_from_outside(const TriangleMesh& mesh, const Ball& ball, const Vec3f& direction,
                            const Vec3f& up, float aspect) {
  constexpr float field_of_view = 45.0f, half_height = 0.41421356f;  // tan(45 degrees / 2)
  constexpr float margin = 1.03f;
  const Vec3f right = normalize(cross(up, direction)), above = cross(direction, right);
  float distance = ball.radius;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t index : mesh.triangles[i].values) {
      const Vec3f p = vertex(mesh, index) - ball.center;
      const float aside = std::max(std::abs(dot(p, above)), std::abs(dot(p, right)) / aspect);
      distance = std::max(distance, dot(p, direction) + margin * aside / half_height);
    }
  }
  return {.position = ball.center + distance * direction,
          .target = ball.center,
          .up = up,
          .vertical_field_of_view = field_of_view};
}

}  // namespace

std::vector<Viewpoint> choose_viewpoints(const TriangleMesh& mesh) {
  const Box3f bounds = bounds_of(mesh);
  const Ball ball = ball_around(bounds);
  std::vector<Viewpoint> viewpoints = choose_inside(mesh, bounds, 2.0f * ball.radius);
  for (const Vec3f& direction :
       {Vec3f{0.6f, 0.35f, 1.0f}, Vec3f{-1.0f, 0.2f, 0.35f}, Vec3f{0.5f, 1.0f, -0.9f}}) {
    viewpoints.push_back(look_from_outside(mesh, ball, normalize(direction), {0, 1, 0}, 4.0f / 3.0f));
  }
  return viewpoints;
}

std::optional<Viewpoint> named_view(const TriangleMesh& mesh, std::string_view name, const Vec3f& up,
                                    float aspect) {
  // Right, front and up as axes: x, z and y, or turned to another up.
  const Vec3f above = normalize(up);
  const Vec3f side = std::abs(above.x) > 0.9f ? Vec3f{0, 1, 0} : Vec3f{1, 0, 0};
  const Vec3f front = normalize(cross(side, above)), right = cross(above, front);
  Vec3f direction, upward = above;
  if (name == "front") direction = front;
  if (name == "back") direction = -1.0f * front;
  if (name == "right") direction = right;
  if (name == "left") direction = -1.0f * right;
  if (name == "top") direction = above, upward = -1.0f * front;
  if (name == "bottom") direction = -1.0f * above, upward = front;
  if (name == "iso") direction = normalize(0.6f * right + 0.35f * above + front);
  if (direction == Vec3f{}) return std::nullopt;
  return look_from_outside(mesh, ball_around(bounds_of(mesh)), direction, upward, aspect);
}

std::vector<Viewpoint> choose_viewpoints(const Scene& scene) {
  return scene.placed ? choose_viewpoints(flattened(*scene.placed, shape_size).mesh())
                      : choose_viewpoints(scene.mesh());
}

std::optional<Viewpoint> named_view(const Scene& scene, std::string_view name, const Vec3f& up,
                                    float aspect) {
  return scene.placed ? named_view(flattened(*scene.placed, shape_size).mesh(), name, up, aspect)
                      : named_view(scene.mesh(), name, up, aspect);
}

}  // namespace workbench
