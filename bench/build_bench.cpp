// The time of the steps of a build: binning, chopping, partition, and the whole tree.
//
//     build/release/bin/build_bench
//     build/release/bin/build_bench --benchmark_filter=Binning

#include <array>
#include <vector>

#include <benchmark/benchmark.h>
#include <kerf/build.hpp>

#include "construction/construct.hpp"
#include "construction/input.hpp"
#include "construction/sbvh/subtree.hpp"
#include "workbench/open/load_scene.hpp"

namespace {

using kerf::Reference;

// Large and small triangles, most of them along no axis, so that there is something to split.
const workbench::Scene& scene() {
  static const workbench::Scene atrium = workbench::load_scene("atrium:rotate=30");
  return atrium;
}

// A node of `count` references: every n-th triangle of the scene.
struct Node {
  std::array<kerf::TriangleMesh, 1> meshes{scene().mesh()};
  kerf::Geometry geometry{meshes};
  std::vector<Reference> references;
  kerf::NodeInput input{};

  explicit Node(std::uint32_t count) {
    const std::vector<Reference> all = kerf::make_references(geometry).references;
    const std::size_t step = all.size() / count;
    for (std::size_t i = 0; i < count; ++i) references.push_back(all[i * step]);
    input.range = {0, count, 2 * count};
    for (const Reference& reference : references) {
      input.box = kerf::merge(input.box, reference.bounds());
      input.doubled_centroids = kerf::merge(input.doubled_centroids, reference.lower + reference.upper);
    }
  }
};

void run_binning(benchmark::State& state, bool spatial) {
  Node node(static_cast<std::uint32_t>(state.range(0)));
  const kerf::BuildContext context{.geometry = spatial ? &node.geometry : nullptr,
                                   .arena = node.references.data()};
  for (auto _ : state) benchmark::DoNotOptimize(kerf::bin_node(context, node.input));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

void ObjectBinning(benchmark::State& state) {
  run_binning(state, false);
}
BENCHMARK(ObjectBinning)->RangeMultiplier(8)->Range(8, 1 << 15);

// Both kinds of bins, and chopping at the most promising planes.
void ObjectAndSpatialBinning(benchmark::State& state) {
  run_binning(state, true);
}
BENCHMARK(ObjectAndSpatialBinning)->RangeMultiplier(8)->Range(64, 1 << 15);

void Chopping(benchmark::State& state) {
  const Node node(4096);
  const kerf::BuildContext context{.geometry = &node.geometry};
  kerf::Box3f left, right;
  for (auto _ : state) {
    for (const Reference& reference : node.references) {
      kerf::chop_reference(context, reference, 0, 0.5f * (reference.lower.x + reference.upper.x), left,
                           right);
      benchmark::DoNotOptimize(left);
      benchmark::DoNotOptimize(right);
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(node.references.size()));
}
BENCHMARK(Chopping);

// Each iteration starts with a copy of the references, whose time is included.
void Partition(benchmark::State& state) {
  const Node node(static_cast<std::uint32_t>(state.range(0)));
  const float middle = 0.5f * (node.input.doubled_centroids.lower.x + node.input.doubled_centroids.upper.x);
  std::vector<Reference> references = node.references;
  const kerf::BuildContext context{.arena = references.data()};
  for (auto _ : state) {
    std::copy(node.references.begin(), node.references.end(), references.begin());
    benchmark::DoNotOptimize(
        kerf::partition_references(context, static_cast<std::uint32_t>(references.size()), 0, middle));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(Partition)->RangeMultiplier(8)->Range(8, 1 << 15);

void WholeTree(benchmark::State& state) {
  const std::array<kerf::TriangleMesh, 1> meshes{scene().mesh()};
  const kerf::Geometry geometry(meshes);
  const kerf::BuildOptions options{.threads = static_cast<unsigned>(state.range(0))};
  for (auto _ : state) benchmark::DoNotOptimize(kerf::construct(geometry, options));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(geometry.triangle_count()));
}
BENCHMARK(WholeTree)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
