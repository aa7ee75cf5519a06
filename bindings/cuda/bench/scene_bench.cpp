#include "scene_bench.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <random>
#include <span>
#include <vector>

#include <kerf/cuda/bvh.hpp>
#include <kerf/kerf.hpp>

#include "../src/content.hpp"
#include "../src/launch.hpp"
#include "peer.hpp"
#include "report.hpp"
#include "workbench/compare/equal_references.hpp"
#include "workbench/open/load_scene.hpp"
#include "workbench/rays/rays.hpp"

namespace kerf::cuda {
namespace {

// One way to trace.
struct Contestant {
  std::string name;
  std::function<void(const Ray*, Hit*, std::size_t)> closest;
  std::function<void(const Ray*, std::uint8_t*, std::size_t)> any;
  std::function<void(const Ray*, std::size_t, bool, TotalCounters*)> counted = {};
  bool exact = true;  // hits must be the library's
  double ms[3] = {1e30, 1e30, 1e30};
  std::size_t different[3] = {0, 0, 0};
  double nodes[3] = {0, 0, 0}, triangles[3] = {0, 0, 0};
};

Contestant contestant(std::string name, const BinaryHierarchy& hierarchy) {
  const MeshTable meshes{nullptr, 1};
  return {std::move(name),
          [=](const Ray* rays, Hit* hits, std::size_t count) {
            launch_closest(hierarchy, meshes, rays, hits, count, nullptr);
          },
          [=](const Ray* rays, std::uint8_t* occluded, std::size_t count) {
            launch_any(hierarchy, rays, occluded, count, nullptr);
          },
          [=](const Ray* rays, std::size_t count, bool any_hit, TotalCounters* totals) {
            launch_counted(hierarchy, rays, count, any_hit, totals, nullptr);
          }};
}

class SceneBench {
 public:
  SceneBench(const std::string& spec, const SceneBenchOptions& options)
      : spec_(spec), options_(options), scene_(workbench::load_scene(spec)), mesh_(scene_.mesh()) {
    say("%s: %zu triangles, %zu viewpoints", spec.c_str(), mesh_.triangles.size(), scene_.viewpoints.size());
    vertices_ = DeviceArray<Vec3f>(std::span<const Vec3f>(scene_.vertices));
    triangles_ = DeviceArray<std::array<std::uint32_t, 3>>(
        std::span<const std::array<std::uint32_t, 3>>(scene_.triangles));
    device_mesh_ = {.vertices = {vertices_.data(), vertices_.size()},
                    .triangles = {triangles_.data(), triangles_.size()}};
  }

  bool run() {
    build_on_the_host();
    build_on_the_device();
    if (options_.peers) add_peers();
    for (const workbench::RayType type : workbench::ray_types) trace(type);
    print();
    if (options_.queries) ask();
    std::printf("RESULT %s %s\n\n", spec_.c_str(), equal_ ? "answers are equal" : "ANSWERS DIFFER");
    std::fflush(stdout);
    return equal_;
  }

 private:
  void add(const std::string& name, const Bvh& bvh) {
    hierarchies_.push_back(bvh);
    contestants_.push_back(contestant(name, bvh_view(bvh)));
  }
  static BinaryHierarchy bvh_view(const Bvh& bvh) {
    const Bvh::Content& content = *bvh.content();
    return {content.nodes.data(), content.triangles.data(), content.bounds.data(),
            static_cast<std::uint32_t>(content.nodes.size())};
  }

  void build_on_the_host() {
    std::size_t sbvh_references = 0;
    for (const BuilderInfo& builder : builders()) {
      kerf::BuildOptions options;
      options.builder = builder.builder;
      const bool presplits = builder.builder == Builder::esc || builder.builder == Builder::evh;
      if (presplits) {
        if (!options_.presplit_builders) continue;
        options.presplit_references = workbench::presplit_references_for(sbvh_references, mesh_, options);
      }
      const auto start = Clock::now();
      const Tree tree = build_tree(mesh_, options);
      const double ms = 1e3 * seconds_since(start);
      const Bvh uploaded(tree);
      say("%s: built on the CPU in %.1f ms; cost %.2f; %zu references; %zu nodes; %.1f MB",
          std::string(builder.name).c_str(), ms, surface_area_cost(tree), uploaded.statistics().references,
          uploaded.statistics().nodes, 1e-6 * static_cast<double>(uploaded.statistics().bytes));
      add(std::string(builder.name), uploaded);
      if (builder.builder != Builder::sbvh) continue;
      sbvh_ = uploaded;
      library_ = make_bvh(tree);
      sbvh_references = library_.statistics().references;
      add("sbvh of the layout", Bvh(library_));
      options.quality = Quality::best;
      add("sbvh, best", Bvh(build_tree(mesh_, options)));
    }
  }

  void build_on_the_device() {
    const struct {
      const char* name;
      cuda::BuildOptions options;
    } ways[] = {{"built, no splits", {.max_reference_ratio = 1.0f}}, {"built, 1.5", {}}};
    for (const auto& way : ways) {
      double first = 0.0, best = 1e30;
      Bvh bvh;
      for (int round = 0; round < 5; ++round) {
        const auto start = Clock::now();
        bvh = Bvh::build({&device_mesh_, 1}, way.options);
        const double ms = 1e3 * seconds_since(start);
        if (round == 0) first = ms;
        best = std::min(best, ms);
      }
      double refit_ms = 1e30;
      for (int round = 0; round < 5; ++round)
        refit_ms = std::min(refit_ms, stopwatch_.milliseconds([&] { bvh.refit({&device_mesh_, 1}); }));
      bvh = Bvh::build({&device_mesh_, 1}, way.options);
      const BvhStatistics& s = bvh.statistics();
      std::printf(
          "BUILD %s: %s: %.2f ms (the first %.2f), %.1f Mtriangles/s; cost %.2f; %zu references; %zu nodes; "
          "%.1f MB, "
          "%.1f of scratch, bound %.1f; refit %.3f ms\n",
          spec_.c_str(), way.name, best, first, 1e-3 * static_cast<double>(s.triangles) / best, s.cost,
          s.references, s.nodes, 1e-6 * static_cast<double>(s.bytes),
          1e-6 * static_cast<double>(s.scratch_bytes),
          1e-6 * static_cast<double>(build_bytes(s.triangles, way.options)), refit_ms);
      add(way.name, bvh);
      built_ = bvh;  // the last is the default
    }
  }

  void add_peers() {
    peers_ = make_peers(scene_.vertices, scene_.triangles);
    for (const auto& peer : peers_) {
      say("%s: built in %.2f ms", peer->name().c_str(), peer->build_ms());
      contestants_.push_back({peer->name(),
                              [p = peer.get()](const Ray* r, Hit* h, std::size_t n) {
                                p->closest(r, h, static_cast<std::uint32_t>(n));
                              },
                              [p = peer.get()](const Ray* r, std::uint8_t* o, std::size_t n) {
                                p->any(r, o, static_cast<std::uint32_t>(n));
                              },
                              {},
                              false});
    }
  }

  void trace(workbench::RayType type) {
    const auto k = static_cast<std::size_t>(type);
    const workbench::RaySet set =
        make_rays(scene_, library_, type, {.width = options_.width, .height = options_.height});
    const std::size_t count = set.rays.size();
    counts_[k] = count;
    if (k == 0) primary_ = set.rays;
    std::vector<Hit> hits(set.any_hit() ? 0 : count), found(hits.size());
    std::vector<std::uint8_t> occluded(set.any_hit() ? count : 0), found_any(occluded.size());
    double seconds = 1e30;
    for (int round = 0; round < 2; ++round) {
      const auto start = Clock::now();
      if (set.any_hit())
        library_.occluded(set.rays, occluded);
      else
        library_.intersect(set.rays, hits);
      seconds = std::min(seconds, seconds_since(start));
    }
    library_mrays_[k] = 1e-6 * static_cast<double>(count) / seconds;
    const DeviceArray<Ray> rays{std::span<const Ray>(set.rays)};
    const DeviceArray<Hit> device_hits(count);
    const DeviceArray<std::uint8_t> device_any(count);
    say("%s: %zu rays", std::string(name(type)).c_str(), count);
    const auto run = [&](const Contestant& c) {
      if (set.any_hit())
        c.any(rays.data(), device_any.data(), count);
      else
        c.closest(rays.data(), device_hits.data(), count);
    };
    for (Contestant& c : contestants_) {
      check(cudaMemset(device_hits.data(), 0x5a, count * sizeof(Hit)), "clearing hits");
      check(cudaMemset(device_any.data(), 0x5a, count), "clearing results");
      run(c);
      check(cudaDeviceSynchronize(), ("tracing with " + c.name).c_str());
      if (set.any_hit()) {
        device_any.copy_to(found_any);
        for (std::size_t i = 0; i < count; ++i) c.different[k] += found_any[i] != occluded[i];
      } else {
        device_hits.copy_to(found);
        for (std::size_t i = 0; i < count; ++i)
          c.different[k] += c.exact ? !(found[i] == hits[i]) : found[i].primitive != hits[i].primitive;
      }
      if (c.exact && c.different[k] != 0) differ(c.name, c.different[k], count);
      if (!c.counted) continue;
      const TotalCounters zero;
      const DeviceArray<TotalCounters> totals{std::span<const TotalCounters>(&zero, 1)};
      c.counted(rays.data(), count, set.any_hit(), totals.data());
      TotalCounters sum;
      totals.copy_to({&sum, 1});
      c.nodes[k] = static_cast<double>(sum.nodes) / static_cast<double>(count);
      c.triangles[k] = static_cast<double>(sum.triangles) / static_cast<double>(count);
    }
    for (int round = 0; round < options_.rounds; ++round)
      for (Contestant& c : contestants_)
        c.ms[k] = std::min(c.ms[k], stopwatch_.milliseconds([&] { run(c); }));
  }

  void differ(const std::string& what, std::size_t different, std::size_t count) {
    equal_ = false;
    say("NOT EQUAL: %s, %zu of %zu", what.c_str(), different, count);
  }

  void print() const {
    std::printf("\nTABLE %s (%zu triangles; %zu primary, %zu ao, %zu diffuse rays)\n", spec_.c_str(),
                mesh_.triangles.size(), counts_[0], counts_[1], counts_[2]);
    std::printf("%-34s %9s %9s %9s   %6s %6s %6s  %5s %5s %5s  differing\n", "Mrays/s", "primary", "ao",
                "diffuse", "nodes", "", "", "tris", "", "");
    std::printf("%-34s %9.1f %9.1f %9.1f\n", "library on the CPU, all threads", library_mrays_[0],
                library_mrays_[1], library_mrays_[2]);
    for (const Contestant& c : contestants_) {
      std::printf(
          "%-34s %9.1f %9.1f %9.1f   ", c.name.c_str(), 1e-3 * static_cast<double>(counts_[0]) / c.ms[0],
          1e-3 * static_cast<double>(counts_[1]) / c.ms[1], 1e-3 * static_cast<double>(counts_[2]) / c.ms[2]);
      if (c.counted)
        std::printf("%6.2f %6.2f %6.2f  %5.2f %5.2f %5.2f", c.nodes[0], c.nodes[1], c.nodes[2],
                    c.triangles[0], c.triangles[1], c.triangles[2]);
      else
        std::printf("%38s", "");
      std::printf("  %zu %zu %zu\n", c.different[0], c.different[1], c.different[2]);
    }
  }

  // A question's answers of the device, compared with the library's and timed beside it.
  template <class T, class Ask, class Answer>
  void ask(const char* what, const char* of, const Bvh& bvh, std::size_t count, std::size_t compared,
           const Ask& ask, const Answer& answer) {
    const DeviceArray<T> results(count);
    check(cudaMemset(results.data(), 0x5a, count * sizeof(T)), "clearing results");
    double ms = 1e30;
    for (int round = 0; round < std::max(1, options_.rounds - 3); ++round)
      ms = std::min(ms, stopwatch_.milliseconds([&] { ask(bvh, results.data()); }));
    std::vector<T> found(count), expected(compared);
    results.copy_to(found);
    const auto start = Clock::now();
    on_all_processors(compared, [&](std::size_t i) { expected[i] = answer(i); });
    const double seconds = seconds_since(start);
    std::size_t different = 0;
    for (std::size_t i = 0; i < compared; ++i) different += !(found[i] == expected[i]);
    std::printf("QUERY %s: %-16s %-12s %8.1f M/s; on the CPU, all threads: %7.2f; differing: %zu of %zu\n",
                spec_.c_str(), what, of, 1e-3 * static_cast<double>(count) / ms,
                1e-6 * static_cast<double>(compared) / seconds, different, compared);
    if (different != 0) differ(what, different, compared);
  }

  void ask() {
    std::mt19937 random(1);
    const Box3f box = library_.bounds();
    std::vector<Vec3f> points(std::min<std::size_t>(1u << 20, options_.width * options_.height));
    for (Vec3f& p : points)
      for (int axis = 0; axis < 3; ++axis)
        p[axis] = box.lower[axis] + (box.upper[axis] - box.lower[axis]) *
                                        (1.2f * static_cast<float>(random() >> 8) * 0x1p-24f - 0.1f);
    const std::size_t count = points.size(), compared = std::min<std::size_t>(count, 200000);
    const std::size_t ray_count = std::min<std::size_t>(primary_.size(), 1u << 20);
    const DeviceArray<Vec3f> device_points{std::span<const Vec3f>(points)};
    const DeviceArray<Ray> rays{std::span<const Ray>(primary_).first(ray_count)};
    const struct {
      const char* name;
      Bvh bvh;
    } ways[] = {{"sbvh", sbvh_}, {"built, 1.5", built_}};
    for (const auto& [of, bvh] : ways) {
      ask<std::uint32_t>(
          "count hits", of, bvh, ray_count, std::min<std::size_t>(ray_count, 100000),
          [&](const Bvh& b, std::uint32_t* out) { b.count_hits(rays.data(), out, ray_count); },
          [&](std::size_t i) { return static_cast<std::uint32_t>(library_.all_hits(primary_[i], {})); });
      ask<std::uint8_t>(
          "contains", of, bvh, count, compared,
          [&](const Bvh& b, std::uint8_t* out) { b.contains(device_points.data(), out, count); },
          [&](std::size_t i) { return static_cast<std::uint8_t>(library_.contains(points[i])); });
      ask<SurfacePoint>(
          "closest point", of, bvh, count, compared,
          [&](const Bvh& b, SurfacePoint* out) { b.closest_point(device_points.data(), out, count); },
          [&](std::size_t i) { return library_.closest_point(points[i]).value_or(SurfacePoint{}); });
      ask<float>(
          "signed distance", of, bvh, count, compared,
          [&](const Bvh& b, float* out) { b.signed_distance(device_points.data(), out, count); },
          [&](std::size_t i) { return library_.signed_distance(points[i]); });
    }
  }

  const std::string spec_;
  const SceneBenchOptions options_;
  const workbench::Scene scene_;
  const TriangleMesh mesh_;
  DeviceArray<Vec3f> vertices_;
  DeviceArray<std::array<std::uint32_t, 3>> triangles_;
  TriangleMesh device_mesh_;
  kerf::Bvh library_;
  std::vector<Bvh> hierarchies_;  // that contestants trace
  Bvh sbvh_, built_;              // that questions are asked
  std::vector<std::unique_ptr<Peer>> peers_;
  std::vector<Contestant> contestants_;
  std::vector<Ray> primary_;
  std::size_t counts_[3] = {};
  double library_mrays_[3] = {};
  Stopwatch stopwatch_;
  bool equal_ = true;
};

}  // namespace

void build_scene(const std::string& spec) {
  const workbench::Scene scene = workbench::load_scene(spec);
  const DeviceArray<Vec3f> vertices{std::span<const Vec3f>(scene.vertices)};
  const DeviceArray<std::array<std::uint32_t, 3>> triangles{
      std::span<const std::array<std::uint32_t, 3>>(scene.triangles)};
  const TriangleMesh mesh{.vertices = {vertices.data(), vertices.size()},
                          .triangles = {triangles.data(), triangles.size()}};
  const Bvh bvh = Bvh::build({&mesh, 1});
  say("%s: built of %zu references", spec.c_str(), bvh.statistics().references);
}

bool bench_scene(const std::string& spec, const SceneBenchOptions& options) {
  return SceneBench(spec, options).run();
}

}  // namespace kerf::cuda
