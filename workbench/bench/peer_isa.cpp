#include "workbench/bench/peer_isa.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "workbench/bench/peers/embree.hpp"

namespace workbench {
namespace {

// The widest that Embree may use beside a target of kerf. Highway has many names for kinds of AVX-512.
std::string_view widest_beside(std::string_view target) {
  if (target.starts_with("AVX3") || target.starts_with("AVX10")) return "avx512";
  if (target == "AVX2") return "avx2";
  if (target == "SSE4") return "sse4.2";
  return "sse2";
}

}  // namespace

std::vector<std::string> isas_up_to(std::string_view target, std::span<const std::string> isas) {
  static constexpr std::string_view widths[] = {"sse2", "sse4.2", "avx", "avx2", "avx512"};
  const auto rank = [](std::string_view isa) { return std::find(std::begin(widths), std::end(widths), isa); };
  std::vector<std::string> list;
  for (const std::string& isa : isas) {
    if (list.empty() || rank(isa) <= rank(widest_beside(target))) list.push_back(isa);
  }
  return list;
}

std::string fastest_isa(const Scene& scene, std::span<const std::string> isas, const BenchOptions& options) {
  if (isas.size() == 1) return isas[0];
  std::vector<Engine> engines;
  for (const std::string& isa : isas) engines.push_back(std::move(embree_engines(options.threads, isa)[0]));

  BenchOptions short_run = options;
  short_run.build_rounds = 0;
  short_run.trace_seconds = 0.0;
  short_run.rays = {.width = options.rays.width / 2, .height = options.rays.height / 2};
  short_run.limits = false;
  short_run.rays_made = {options.rays_made.front()};
  const BenchScene figures = bench_scene(scene, engines, short_run);

  std::string fastest;
  double best = 0.0;
  for (const BenchResult& result : figures.results) {
    if (result.engine != "embree-high") continue;
    double product = 1.0;
    for (const BenchRays& rays : result.rays) product *= rays.mrays_per_s;
    if (fastest.empty() || product > best) {
      fastest = result.isa;
      best = product;
    }
  }
  return fastest;
}

}  // namespace workbench
