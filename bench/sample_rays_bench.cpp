// Trees made for a sample of rays beside trees made without, on other rays of the same kinds: the sample is
// of smaller pictures than those that are traced.
//
//     build/release/bin/sample_rays_bench SCENE...
//
// On one thread, rays in an array, all trees interleaved. `fast` and `best` are the qualities; a figure is
// the speed with the sample over that without.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <kerf/error.hpp>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>
#include <tbb/global_control.h>

#include "workbench/open/load_scene.hpp"
#include "workbench/rays/rays.hpp"
#include "workbench/rays/slice_timer.hpp"

namespace {

using namespace workbench;
constexpr kerf::Quality qualities[] = {kerf::Quality::fast, kerf::Quality::best};

std::vector<RaySet> make_all_rays(const Scene& scene, const kerf::Bvh& bvh, const RaySetOptions& pixels) {
  std::vector<RaySet> sets;
  for (const RayType type : ray_types) sets.push_back(make_rays(scene, bvh, type, pixels));
  return sets;
}

// The seconds that each hierarchy takes for the rays of `set`, one by one.
std::vector<double> trace(std::span<const kerf::Bvh> hierarchies, const RaySet& set) {
  constexpr std::size_t slice = 16384;
  std::vector<TraceRange> tracers;
  std::vector<std::size_t> hits(hierarchies.size());
  for (std::size_t i = 0; i < hierarchies.size(); ++i) {
    tracers.emplace_back([&, i](std::size_t begin, std::size_t end) {
      for (; begin < end; ++begin) {
        const kerf::Ray& ray = set.rays[begin];
        hits[i] += set.any_hit() ? hierarchies[i].occluded(ray) : hierarchies[i].intersect(ray).has_value();
      }
    });
  }
  std::vector<double> seconds;
  for (const SliceTimes& times : time_slices(tracers, set.rays.size(), (set.rays.size() + slice - 1) / slice,
                                             {.rounds = 7, .seconds = 2.0}))
    seconds.push_back(times.seconds);
  if (std::adjacent_find(hits.begin(), hits.end(), std::not_equal_to<>()) != hits.end()) {
    fmt::print(stderr, "sample_rays_bench: the trees do not hit the same\n");
    std::exit(EXIT_FAILURE);
  }
  return seconds;
}

struct Mean {
  double sum = 0.0, least = INFINITY;
  int count = 0;

  void add(double ratio) {
    sum += std::log(ratio);
    least = std::min(least, ratio);
    ++count;
  }
  double value() const { return std::exp(sum / std::max(count, 1)); }
};

// A column for each quality.
void run(const std::string& spec, std::span<Mean> means) {
  const Scene scene = load_scene(spec);
  kerf::BuildOptions options;
  options.threads = 1;
  const kerf::Bvh plain = kerf::build(scene.mesh(), options);
  std::vector<kerf::Ray> sample;
  for (const RaySet& set :
       make_all_rays(scene, plain, affordable(scene, plain, {.width = 128, .height = 96})))
    sample.insert(sample.end(), set.rays.begin(), set.rays.end());
  std::vector<kerf::Bvh> hierarchies;  // without and with the sample, quality after quality
  for (const kerf::Quality quality : qualities) {
    options.quality = quality;
    for (const std::span<const kerf::Ray> rays :
         {std::span<const kerf::Ray>(), std::span<const kerf::Ray>(sample)}) {
      options.sample_rays = rays;
      hierarchies.push_back(kerf::build(scene.mesh(), options));
    }
  }
  for (const RaySet& set : make_all_rays(scene, plain, affordable(scene, plain, {}))) {
    if (set.rays.empty()) continue;
    const std::vector<double> seconds = trace(hierarchies, set);
    fmt::print("{:32} {:8}", spec, name(set.type));
    for (std::size_t q = 0; q < std::size(qualities); ++q) {
      const double ratio = seconds[2 * q] / seconds[2 * q + 1];
      means[q].add(ratio);
      fmt::print(" {:6.3f}", ratio);
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  Mean means[std::size(qualities)];
  try {
    fmt::print("{:32} {:8} {:>6} {:>6}  with {}\n", "scene", "rays", "fast", "best", kerf::instruction_set());
    for (int i = 1; i < argc; ++i) run(argv[i], means);
  } catch (const kerf::Error& error) {
    fmt::print(stderr, "sample_rays_bench: {}\n", error.what());
    return 1;
  }
  fmt::print("{:41} {:6.3f} {:6.3f}\n{:41} {:6.3f} {:6.3f}\n", "geometric mean", means[0].value(),
             means[1].value(), "least", means[0].least, means[1].least);
  return 0;
}
