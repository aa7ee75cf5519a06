// Builds over any vertices and indices, with any options.
#include <array>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <fuzzer/FuzzedDataProvider.h>

#include "fuzz/forged_file.hpp"

namespace {

// Any bits, or a point of a small grid, on which everything is aligned.
float coordinate(FuzzedDataProvider& input, bool grid) {
  if (grid) return static_cast<float>(input.ConsumeIntegralInRange<int>(-4, 4));
  const auto bits = input.ConsumeIntegral<std::uint32_t>();
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider input(data, size);
  kerf::BuildOptions options;
  options.builder = static_cast<kerf::Builder>(input.ConsumeIntegralInRange(0, 4));
  options.alpha = input.ConsumeBool() ? 0.0f : coordinate(input, false);
  options.max_reference_ratio = input.ConsumeBool() ? 2.0f : coordinate(input, false);
  options.max_leaf_size = input.ConsumeIntegralInRange(0u, 9u);
  options.threads = input.ConsumeIntegralInRange(0u, 3u);

  const bool grid = input.ConsumeBool();
  std::vector<std::array<float, 3>> vertices(input.ConsumeIntegralInRange<std::size_t>(0, 64));
  for (auto& vertex : vertices) {
    for (float& value : vertex) value = coordinate(input, grid);
  }
  const auto end = static_cast<std::uint32_t>(vertices.size() + (input.ConsumeProbability<float>() > 0.99f));
  std::vector<std::uint32_t> indices;
  const std::size_t triangles = end == 0 ? 0 : input.ConsumeIntegralInRange<std::size_t>(0, 200);
  while (indices.size() < 3 * triangles) {
    indices.push_back(input.ConsumeIntegralInRange<std::uint32_t>(0, end - 1));
  }
  const kerf::TriangleMesh meshes[] = {{.vertices = vertices, .triangles = indices}, {}};
  try {
    const kerf::Bvh bvh = kerf::build(meshes, options);
    forged::query(bvh);
    const kerf::BvhStatistics& statistics = bvh.statistics();
    if (bvh.triangles_in(bvh.bounds()).size() != statistics.triangles - statistics.degenerate_triangles) {
      std::abort();  // every triangle with an area must be found, once
    }
  } catch (const kerf::Error&) {
  }
  return 0;
}
