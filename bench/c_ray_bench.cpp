// Single rays through the C interface beside the same rays through the one in C++, on one thread: closest and
// any hit, each ray made right before its call.
//
//     build/release/bin/c_ray_bench [SCENE] [ROUNDS]      (the atrium, 9 rounds)
//
// Both trace blocks of rays by turns, one first and then the other; the best time of each block counts. C++
// is linked as one static program; C calls the shared library, as programs in other languages do.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <kerf/kerf.h>
#include <kerf/kerf.hpp>

#include "workbench/base/vectors.hpp"
#include "workbench/open/load_scene.hpp"
#include "workbench/sampling/random.hpp"
#include "workbench/sampling/random_direction.hpp"

namespace {

using namespace workbench;
using Clock = std::chrono::steady_clock;

constexpr std::size_t blocks = 100, rays_per_block = 2000;

// From random triangles in random directions.
std::vector<kerf::Ray> make_rays(const Scene& scene) {
  RandomNumbers random(1);
  std::vector<kerf::Ray> rays(blocks * rays_per_block);
  for (kerf::Ray& ray : rays) {
    const auto& [i, j, k] = scene.triangles[random.below(static_cast<std::uint32_t>(scene.triangles.size()))];
    const float third = 1.0f / 3.0f;
    ray = {.origin = third * scene.vertices[i] + third * scene.vertices[j] + third * scene.vertices[k],
           .direction = random_direction(random),
           .t_min = 1e-3f};
  }
  return rays;
}

double seconds_of(const auto& work) {
  const Clock::time_point begin = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

struct Times {
  std::array<double, blocks> in_c, in_cpp;
  Times() {
    in_c.fill(1e9);
    in_cpp.fill(1e9);
  }
};

// `first` and `second` trace a ray and count hits, which have to be the same.
void compare(const char* name, const std::vector<kerf::Ray>& rays, int rounds, const auto& in_c,
             const auto& in_cpp) {
  Times times;
  std::size_t hits_in_c = 0, hits_in_cpp = 0;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t block = 0; block < blocks; ++block) {
      const kerf::Ray* const first = rays.data() + block * rays_per_block;
      const auto trace_in_c = [&] {
        times.in_c[block] = std::min(times.in_c[block], seconds_of([&] {
                                       for (std::size_t i = 0; i < rays_per_block; ++i)
                                         hits_in_c += in_c(first[i]);
                                     }));
      };
      const auto trace_in_cpp = [&] {
        times.in_cpp[block] = std::min(times.in_cpp[block], seconds_of([&] {
                                         for (std::size_t i = 0; i < rays_per_block; ++i)
                                           hits_in_cpp += in_cpp(first[i]);
                                       }));
      };
      if ((round + static_cast<int>(block)) % 2 == 0) {
        trace_in_c();
        trace_in_cpp();
      } else {
        trace_in_cpp();
        trace_in_c();
      }
    }
  }
  double c = 0.0, cpp = 0.0;
  for (std::size_t block = 0; block < blocks; ++block) {
    c += times.in_c[block];
    cpp += times.in_cpp[block];
  }
  const double per_ray = 1e9 / static_cast<double>(rays.size());
  std::printf("%-8s  C++ %7.1f ns  C %7.1f ns  C over C++ %.3f%s\n", name, cpp * per_ray, c * per_ray,
              c / cpp, hits_in_c == hits_in_cpp ? "" : "  OTHER HITS");
}

}  // namespace

int main(int count, char** arguments) {
  const Scene scene = load_scene(count > 1 ? arguments[1] : "atrium");
  const int rounds = count > 2 ? std::atoi(arguments[2]) : 9;
  const kerf::Bvh bvh = kerf::build({.vertices = scene.vertices, .triangles = scene.triangles});
  kerf_mesh mesh = KERF_MESH_INIT;
  mesh.vertices = &scene.vertices[0].x;
  mesh.vertex_count = scene.vertices.size();
  mesh.triangles = &scene.triangles[0][0];
  mesh.triangle_count = scene.triangles.size();
  kerf_bvh* handle = nullptr;
  if (kerf_build(&mesh, 1, nullptr, &handle) != KERF_OK) {
    std::fprintf(stderr, "%s\n", kerf_last_error());
    return 1;
  }
  const std::vector<kerf::Ray> rays = make_rays(scene);
  const auto in_c = [](const kerf::Ray& ray) {
    return kerf_ray{{ray.origin.x, ray.origin.y, ray.origin.z},
                    {ray.direction.x, ray.direction.y, ray.direction.z},
                    ray.t_min,
                    ray.t_max};
  };
  const auto in_cpp = [](const kerf::Ray& ray) {
    return kerf::Ray{.origin = {ray.origin.x, ray.origin.y, ray.origin.z},
                     .direction = {ray.direction.x, ray.direction.y, ray.direction.z},
                     .t_min = ray.t_min,
                     .t_max = ray.t_max};
  };
  compare(
      "closest", rays, rounds,
      [&](const kerf::Ray& from) {
        const kerf_ray ray = in_c(from);
        kerf_hit hit;
        return static_cast<std::size_t>(kerf_intersect(handle, &ray, &hit) != 0 && hit.t > 0.0f);
      },
      [&](const kerf::Ray& from) {
        const kerf::Ray ray = in_cpp(from);
        kerf::Hit hit;
        return static_cast<std::size_t>(bvh.intersect(ray, hit) && hit.t > 0.0f);
      });
  compare(
      "any", rays, rounds,
      [&](const kerf::Ray& from) {
        const kerf_ray ray = in_c(from);
        return static_cast<std::size_t>(kerf_occluded(handle, &ray) != 0);
      },
      [&](const kerf::Ray& from) { return static_cast<std::size_t>(bvh.occluded(in_cpp(from))); });
  kerf_bvh_release(handle);
}
