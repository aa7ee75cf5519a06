#include "workbench/rays/rays.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include <kerf/inspect.hpp>

#include "workbench/base/vectors.hpp"
#include "workbench/rays/camera.hpp"
#include "workbench/sampling/angles.hpp"
#include "workbench/sampling/random.hpp"

namespace workbench {
namespace {

using namespace kerf;

constexpr std::size_t tile_size = 8;

/// Pixels of a picture that several hierarchies share, on each side. One pixel alone would see the middle of
/// the scene and nothing else.
constexpr std::size_t min_side = 2;

/// Length of an ambient-occlusion ray, in diagonals of the scene.
constexpr float ao_reach = 0.25f;

/// The distance of the start of a secondary ray from its surface, in diagonals of the scene. It must exceed
/// the rounding error of the hit point, 1e-7 of the coordinates. It is less than a millimetre in a room of
/// twenty metres.
constexpr float secondary_offset = 1e-5f;

template <class Visit>
void for_each_pixel_in_tiles(const RaySetOptions& size, Visit&& visit) {
  for (std::size_t tile_y = 0; tile_y < size.height; tile_y += tile_size) {
    for (std::size_t tile_x = 0; tile_x < size.width; tile_x += tile_size) {
      for (std::size_t y = tile_y; y < std::min(tile_y + tile_size, size.height); ++y) {
        for (std::size_t x = tile_x; x < std::min(tile_x + tile_size, size.width); ++x) visit(x, y);
      }
    }
  }
}

RaySet primary_rays(const Scene& scene, const RaySetOptions& size) {
  RaySet set{.type = RayType::primary, .rays = {}};
  CameraRays maker;
  const std::size_t count = scene.viewpoints.size() * size.width * size.height;
  set.rays.reserve(count);
  maker.samples.reserve(count);
  for (const Viewpoint& viewpoint : scene.viewpoints) {
    const auto number = static_cast<std::uint32_t>(maker.cameras.size());
    const Camera& camera = maker.cameras.emplace_back(viewpoint, size.width, size.height);
    for_each_pixel_in_tiles(size, [&](std::size_t column, std::size_t row) {
      const float x = static_cast<float>(column) + 0.5f, y = static_cast<float>(row) + 0.5f;
      set.rays.push_back(camera.ray_through(x, y));
      maker.samples.push_back({x, y, 1.0f / length(camera.way_to(x, y)), number});
    });
  }
  set.maker = std::move(maker);
  return set;
}

struct SurfacePoint {
  Vec3f position;
  Vec3f normal;  ///< unit length, on the side that the ray came from
};

SurfacePoint surface_at(const Ray& ray, const Met& met) {
  const auto& [v0, v1, v2] = met.triangle;
  const Vec3f position = (1.0f - met.u - met.v) * v0 + met.u * v1 + met.v * v2;
  // In double precision the normals of tiny and huge triangles neither underflow nor overflow.
  const double ex = double{v1.x} - v0.x, ey = double{v1.y} - v0.y, ez = double{v1.z} - v0.z;
  const double fx = double{v2.x} - v0.x, fy = double{v2.y} - v0.y, fz = double{v2.z} - v0.z;
  const double nx = ey * fz - ez * fy, ny = ez * fx - ex * fz, nz = ex * fy - ey * fx;
  double scale = 1.0 / std::sqrt(nx * nx + ny * ny + nz * nz);
  if (nx * ray.direction.x + ny * ray.direction.y + nz * ray.direction.z > 0.0) scale = -scale;
  return {position,
          {static_cast<float>(scale * nx), static_cast<float>(scale * ny), static_cast<float>(scale * nz)}};
}

// From here a ray leaves in a direction whose density is proportional to the cosine of its angle to the
// normal: a uniform point of the unit disc, lifted to the hemisphere (Malley's method).
SurfaceRays::Sample cosine_distributed(const SurfacePoint& point, RandomNumbers& random) {
  const Vec3f& normal = point.normal;
  const float r2 = random.uniform();
  const float r = std::sqrt(r2);
  const auto [sine, cosine] = sine_cosine(random.uniform());
  // The basis of Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
  const float sign = std::copysign(1.0f, normal.z);
  const float a = -1.0f / (sign + normal.z);
  const float b = normal.x * normal.y * a;
  const Vec3f tangent{1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
  const Vec3f bitangent{b, sign + normal.y * normal.y * a, -normal.y};
  return {point.position, normal, r * cosine * tangent + r * sine * bitangent, std::sqrt(1.0f - r2)};
}

float max_abs_coordinate(const Box3f& box) {
  float max = 0.0f;
  for (int axis = 0; axis < 3; ++axis) {
    max = std::max({max, std::abs(box.lower[axis]), std::abs(box.upper[axis])});
  }
  return max;
}

}  // namespace

std::string_view name(RayType type) {
  switch (type) {
    case RayType::primary:
      return "primary";
    case RayType::ao:
      return "ao";
    case RayType::diffuse:
      return "diffuse";
  }
  return "";
}

RaySet make_rays(const Scene& scene, const Bvh& bvh, RayType type, const RaySetOptions& options) {
  return make_rays(Traced(scene, bvh), type, options);
}

RaySet make_rays(const Traced& traced, RayType type, const RaySetOptions& options) {
  RaySet primary = primary_rays(traced.scene(), options);
  if (type == RayType::primary) return primary;
  RaySet set{.type = type, .rays = {}};
  const Box3f bounds = traced.bounds();
  if (bounds.empty()) return set;

  const std::vector<std::optional<Met>> hits = traced.intersect(primary.rays);
  const float diagonal = length(extent(bounds));
  const float rounding = 8.0f * std::numeric_limits<float>::epsilon() * max_abs_coordinate(bounds);
  SurfaceRays maker;
  maker.offset = std::max(secondary_offset * diagonal, rounding);
  if (type == RayType::ao) maker.t_max = ao_reach * diagonal;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i]) continue;
    RandomNumbers random(i);
    maker.samples.push_back(cosine_distributed(surface_at(primary.rays[i], *hits[i]), random));
    const MadeRay ray = maker.make(maker.samples.size() - 1);
    set.rays.push_back({.origin = ray.origin, .direction = ray.direction, .t_max = maker.t_max});
  }
  set.maker = std::move(maker);
  return set;
}

double visits_per_ray(const Bvh& bvh, std::span<const Ray> rays, std::uint64_t max_visits) {
  // Triangles that a ray meets at the same t are told apart in double precision.
  constexpr std::uint64_t visits_per_tie = 16;
  TraversalCounters counters;
  std::size_t traced = 0, ties = 0;
  const auto visits = [&] { return counters.steps + counters.triangle_tests + visits_per_tie * ties; };
  for (const Ray& ray : rays) {
    if (const auto hit = intersect(bvh, ray, counters)) {
      Ray there = ray;
      there.t_min = there.t_max = hit->t;
      ties += std::max<std::size_t>(bvh.all_hits(there, std::span<Hit>()), 1) - 1;
    }
    ++traced;
    if (visits() > max_visits) break;
  }
  return traced == 0 ? 0.0 : static_cast<double>(visits()) / static_cast<double>(traced);
}

RaySetOptions affordable(const Scene& scene, const Bvh& bvh, const RaySetOptions& options,
                         std::uint64_t max_visits, std::size_t hierarchies) {
  constexpr RaySetOptions probe{.width = 32, .height = 24};
  const double rays = static_cast<double>(scene.viewpoints.size() * options.width * options.height);
  const double wanted = visits_per_ray(bvh, primary_rays(scene, probe).rays, max_visits / 4) * rays;
  if (wanted <= static_cast<double>(max_visits)) return options;
  const double share = static_cast<double>(max_visits) / static_cast<double>(hierarchies);
  const double scale = std::sqrt(share / wanted);
  // One tile is left of each picture, which the hierarchies share as well.
  const auto least =
      std::max(min_side, static_cast<std::size_t>(tile_size / std::sqrt(static_cast<double>(hierarchies))));
  const auto shrink = [&](std::size_t side) {
    const auto pixels = static_cast<std::size_t>(scale * static_cast<double>(side));
    // Whole tiles, or a part of one.
    const std::size_t rounded = pixels < tile_size ? pixels : pixels - pixels % tile_size;
    return std::min(side, std::max(rounded, least));
  };
  return {.width = shrink(options.width), .height = shrink(options.height)};
}

}  // namespace workbench
