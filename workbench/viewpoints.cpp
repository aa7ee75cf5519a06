#include "workbench/viewpoints.hpp"

#include <algorithm>
#include <cmath>

#include <kerf/build.hpp>

#include "math/box3f.hpp"
#include "workbench/generate/angles.hpp"

namespace workbench {
namespace {

using namespace kerf;

/// Enough triangles to tell open places from closed ones; the hierarchy over so many is built in no time.
constexpr std::size_t sample_size = 100'000;

struct Candidate {
  Viewpoint viewpoint;
  float openness;
};

Box3f bounds_of(const TriangleMesh& mesh) {
  Box3f bounds;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t vertex : mesh.triangles[i].values) {
      const auto [x, y, z] = mesh.vertices[vertex].values;
      bounds = merge(bounds, Vec3f{x, y, z});
    }
  }
  return bounds;
}

Bvh build_sample(const TriangleMesh& mesh) {
  TriangleMesh sample = mesh;
  const std::size_t step = 1 + (mesh.triangles.size() - 1) / sample_size;
  sample.triangles = {mesh.triangles.data(), (mesh.triangles.size() + step - 1) / step,
                      step * mesh.triangles.stride()};
  return build(sample, {.builder = Builder::bvh, .progress = {}});
}

// How far one sees from `position` in directions all round, and the direction in which it is farthest. Rays
// that leave the scene count as nothing seen.
Candidate look_around(const Bvh& bvh, const Vec3f& position, float diagonal) {
  constexpr int directions = 16;
  constexpr float slopes[] = {-0.6f, -0.15f, 0.0f, 0.3f};
  Candidate best{.viewpoint = {.position = position, .target = position + Vec3f{0, 0, -diagonal}},
                 .openness = 0};
  float sum = 0.0f, nearest = diagonal, farthest = 0.0f;
  for (int i = 0; i < directions; ++i) {
    const auto [sine, cosine] = sine_cosine(static_cast<double>(i) / directions);
    for (const float slope : slopes) {
      const Vec3f direction = normalize({cosine, slope, sine});
      const auto hit = bvh.intersect({.origin = position, .direction = direction});
      if (!hit) continue;
      sum += hit->t;
      nearest = std::min(nearest, hit->t);
      if (slope == slopes[1] && hit->t > farthest) {
        farthest = hit->t;
        best.viewpoint.target = position + hit->t * direction;
      }
    }
  }
  // A wall close by fills the picture with nothing to see.
  best.openness = sum / (directions * std::size(slopes)) * std::min(1.0f, nearest / (0.03f * diagonal));
  return best;
}

std::vector<Viewpoint> choose_inside(const TriangleMesh& mesh, const Box3f& bounds, float diagonal) {
  const Bvh bvh = build_sample(mesh);
  std::vector<Candidate> candidates;
  for (const float y : {0.25f, 0.5f, 0.7f}) {
    for (const float x : {0.12f, 0.3f, 0.5f, 0.7f, 0.88f}) {
      for (const float z : {0.12f, 0.3f, 0.5f, 0.7f, 0.88f}) {
        const Vec3f e = extent(bounds);
        candidates.push_back(look_around(bvh, bounds.lower + Vec3f{x * e.x, y * e.y, z * e.z}, diagonal));
      }
    }
  }
  // The most open one, then twice the one that is open and far from those chosen before.
  std::vector<Viewpoint> chosen;
  while (chosen.size() < 3) {
    const auto worth = [&](const Candidate& candidate) {
      float apart = 0.25f * diagonal;
      for (const Viewpoint& other : chosen) {
        apart = std::min(apart, length(other.position - candidate.viewpoint.position));
      }
      return candidate.openness * apart;
    };
    const auto best = std::max_element(candidates.begin(), candidates.end(),
                                       [&](const auto& a, const auto& b) { return worth(a) < worth(b); });
    chosen.push_back(best->viewpoint);
  }
  return chosen;
}

}  // namespace

std::vector<Viewpoint> choose_viewpoints(const TriangleMesh& mesh) {
  const Box3f bounds = bounds_of(mesh);
  const Vec3f center = 0.5f * bounds.lower + 0.5f * bounds.upper;
  const float far_from_origin = std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)});
  // What has no extent is looked at from a distance that a float can still tell from none.
  float radius = std::max(0.5f * length(extent(bounds)), 1e-5f * far_from_origin);
  if (radius == 0.0f) radius = 1.0f;

  std::vector<Viewpoint> viewpoints = choose_inside(mesh, bounds, 2.0f * radius);
  for (const Vec3f& direction :
       {Vec3f{0.6f, 0.35f, 1.0f}, Vec3f{-1.0f, 0.2f, 0.35f}, Vec3f{0.5f, 1.0f, -0.9f}}) {
    constexpr float field_of_view = 45.0f;
    constexpr float distance =
        2.2f;  // in radii; 2.6 would leave room all round the sphere that encloses the mesh
    viewpoints.push_back({.position = center + distance * radius * normalize(direction),
                          .target = center,
                          .up = {0, 1, 0},
                          .vertical_field_of_view = field_of_view});
  }
  return viewpoints;
}

}  // namespace workbench
