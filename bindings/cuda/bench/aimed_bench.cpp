#include "aimed_bench.hpp"

#include <algorithm>
#include <random>
#include <span>
#include <vector>

#include <kerf/cuda/bvh.hpp>
#include <kerf/kerf.hpp>

#include "aimed.hpp"
#include "report.hpp"
#include "workbench/rays/aimed_rays.hpp"

namespace kerf::cuda {
namespace {

// A point inside: half way between the first two crossings of a line from outside.
Vec3f point_inside(const workbench::Solid& solid, const kerf::Bvh& bvh, std::mt19937& random) {
  const Box3f box = bvh.bounds();
  float margin = 0.0f;
  for (int axis = 0; axis < 3; ++axis) margin = std::max(margin, 1e-5f * (box.upper[axis] - box.lower[axis]));
  const auto uniform = [&](float low, float high) {
    return low + (high - low) * (static_cast<float>(random() >> 8) * 0x1p-24f);
  };
  while (true) {
    Vec3f outside;
    for (int axis = 0; axis < 3; ++axis) {
      const float center = 0.5f * box.lower[axis] + 0.5f * box.upper[axis];
      const float half = 1.5f * (box.upper[axis] - box.lower[axis]);
      outside[axis] = uniform(center - half, center + half);
    }
    if (bvh.contains(outside)) continue;
    const Vec3f target = solid.vertices[solid.triangles[random() % solid.triangles.size()][0]];
    Hit hits[2];
    Ray ray{.origin = outside, .direction = {}};
    for (int axis = 0; axis < 3; ++axis) ray.direction[axis] = target[axis] - outside[axis];
    if (bvh.all_hits(ray, hits) < 2) continue;
    Vec3f inside;
    for (int axis = 0; axis < 3; ++axis)
      inside[axis] = outside[axis] + 0.5f * (hits[0].t + hits[1].t) * ray.direction[axis];
    if (bvh.contains(inside) && !bvh.closest_point(inside, margin)) return inside;
  }
}

struct Totals {
  std::uint64_t rays = 0, leaks = 0, different = 0, compared = 0;
};

void bench_solid(const workbench::NamedSolid& named_solid, std::uint64_t ray_count, Totals& totals) {
  constexpr std::size_t batch = 1u << 22, inside_count = 4096;
  const workbench::Solid& solid = named_solid.solid;
  const TriangleMesh mesh{.vertices = solid.vertices, .triangles = solid.triangles};
  const DeviceArray<Vec3f> vertices{std::span<const Vec3f>(solid.vertices)};
  const DeviceArray<std::array<std::uint32_t, 3>> triangles{
      std::span<const std::array<std::uint32_t, 3>>(solid.triangles)};
  const TriangleMesh device_mesh{.vertices = {vertices.data(), vertices.size()},
                                 .triangles = {triangles.data(), triangles.size()}};
  const kerf::Bvh library = kerf::build(mesh);
  const Bvh uploaded(library), built = Bvh::build({&device_mesh, 1});
  std::vector<Vec3f> inside(inside_count);
  on_all_processors(inside_count, [&](std::size_t i) {
    std::mt19937 random(static_cast<unsigned>(i + 1));
    inside[i] = point_inside(solid, library, random);
  });
  const DeviceArray<Vec3f> points{std::span<const Vec3f>(inside)};
  const Box3f box = library.bounds();
  AimedSource aimed{vertices.data(),
                    triangles.data(),
                    points.data(),
                    static_cast<std::uint32_t>(solid.triangles.size()),
                    inside_count,
                    {},
                    0.0f};
  for (int axis = 0; axis < 3; ++axis) {
    aimed.center[axis] = 0.5f * box.lower[axis] + 0.5f * box.upper[axis];
    aimed.radius += box.upper[axis] - box.lower[axis];
  }
  const DeviceArray<Ray> rays(batch);
  const DeviceArray<Hit> hits(batch);
  const DeviceArray<std::uint8_t> results(batch);
  const unsigned long long zero[4] = {};
  const DeviceArray<unsigned long long> misses{std::span<const unsigned long long>(zero)};
  std::uint64_t different = 0;
  for (std::uint64_t first = 0; first < ray_count; first += batch) {
    const std::size_t count = std::min<std::uint64_t>(batch, ray_count - first);
    make_aimed_rays(aimed, first, static_cast<std::uint32_t>(count), rays.data());
    int place = 0;
    for (const Bvh& bvh : {uploaded, built}) {
      bvh.intersect(rays.data(), hits.data(), count);
      count_misses(hits.data(), static_cast<std::uint32_t>(count), misses.data() + place++);
      bvh.occluded(rays.data(), results.data(), count);
      count_misses(results.data(), static_cast<std::uint32_t>(count), misses.data() + place++);
      if (first != 0) continue;
      const std::size_t sample = std::min<std::size_t>(count, 200000);
      std::vector<Ray> sample_rays(sample);
      std::vector<Hit> sample_hits(sample), expected(sample);
      rays.copy_to(sample_rays);
      hits.copy_to(sample_hits);
      library.intersect(sample_rays, expected);
      for (std::size_t i = 0; i < sample; ++i) different += !(sample_hits[i] == expected[i]);
      totals.compared += sample;
    }
  }
  unsigned long long leaks[4];
  misses.copy_to(leaks);
  say("%-34s %6zu triangles: leaks %llu %llu %llu %llu; differing from the library %llu",
      named_solid.name.c_str(), solid.triangles.size(), leaks[0], leaks[1], leaks[2], leaks[3],
      static_cast<unsigned long long>(different));
  totals.rays += ray_count;
  totals.leaks += leaks[0] + leaks[1] + leaks[2] + leaks[3];
  totals.different += different;
}

}  // namespace

bool bench_aimed_rays(std::uint64_t total) {
  const std::vector<workbench::NamedSolid> solids = workbench::make_watertight_solids();
  Totals totals;
  for (const workbench::NamedSolid& solid : solids)
    bench_solid(solid, (total + solids.size() - 1) / solids.size(), totals);
  std::printf("AIMED %llu rays, each traced four ways: %llu leaks; %llu of %llu compared differ\n",
              static_cast<unsigned long long>(totals.rays), static_cast<unsigned long long>(totals.leaks),
              static_cast<unsigned long long>(totals.different),
              static_cast<unsigned long long>(totals.compared));
  return totals.leaks == 0 && totals.different == 0;
}

}  // namespace kerf::cuda
