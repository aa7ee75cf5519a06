// The rays with which engines and builders are compared. They are the same for the same scene, in every run
// and on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include <kerf/bvh.hpp>
#include <kerf/ray.hpp>

#include "workbench/rays/ray_makers.hpp"
#include "workbench/scene/scene.hpp"
#include "workbench/scene/traced.hpp"

namespace workbench {

enum class RayType {
  primary,  ///< through the pixels of every viewpoint, closest hit
  ao,  ///< ambient occlusion: cosine-distributed from primary hits, a quarter of the diagonal long, any hit
  diffuse,  ///< cosine-distributed from primary hits, unbounded, closest hit
};

inline constexpr RayType ray_types[] = {RayType::primary, RayType::ao, RayType::diffuse};

std::string_view name(RayType type);

struct RaySet {
  RayType type;
  std::vector<kerf::Ray> rays;  ///< viewpoint after viewpoint, each in tiles of 8 by 8 pixels

  /// Makes the same rays, bit by bit, one at a time.
  std::variant<CameraRays, SurfaceRays> maker = {};

  bool any_hit() const { return type == RayType::ao; }
};

struct RaySetOptions {
  std::size_t width = 256;  ///< pixels of each viewpoint
  std::size_t height = 192;

  bool operator==(const RaySetOptions&) const = default;
};

/// The rays of `type` for all viewpoints of `scene`. `bvh` is any hierarchy of the scene, which finds the
/// primary hits from which secondary rays start.
RaySet make_rays(const Scene& scene, const kerf::Bvh& bvh, RayType type, const RaySetOptions& options = {});

/// The same for a scene of either kind.
RaySet make_rays(const Traced& traced, RayType type, const RaySetOptions& options = {});

/// Visits of nodes and tests of triangles that the rays of one type may take. Scenes that are scenes take a
/// fraction of it; where everything lies over one another, a ray tests every triangle.
inline constexpr std::uint64_t max_visits_of_a_pass = std::uint64_t{1} << 28;

/// What tracing the closest hits of `rays` takes, each on average: visits of nodes, tests of triangles, and
/// what telling apart triangles at the same t adds. Of the first rays only, if these take `max_visits`.
double visits_per_ray(const kerf::Bvh& bvh, std::span<const kerf::Ray> rays, std::uint64_t max_visits);

/// `options`, or a smaller picture if its primary rays would take more than `max_visits`. Then as many
/// `hierarchies` as trace these rays share the visits. The same on every run, since it counts and does not
/// time.
RaySetOptions affordable(const Scene& scene, const kerf::Bvh& bvh, const RaySetOptions& options,
                         std::uint64_t max_visits = max_visits_of_a_pass, std::size_t hierarchies = 1);

}  // namespace workbench
