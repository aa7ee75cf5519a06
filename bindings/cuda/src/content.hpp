// What a hierarchy on the device holds.
#pragma once

#include <memory>
#include <vector>

#include <kerf/cuda/bvh.hpp>

#include "binary_layout.hpp"
#include "device_array.hpp"
#include "trace.hpp"

namespace kerf::cuda {

struct Bvh::Content {
  DeviceArray<PairNode> nodes;
  DeviceArray<DeviceTriangle> triangles;
  DeviceArray<std::uint32_t> numbers;  // of these triangles, counted over all meshes
  DeviceArray<SceneBounds> bounds;     // one
  DeviceArray<std::uint32_t> first_triangles;
  DeviceArray<std::uint32_t> problems;     // one, which refitting writes and nobody reads
  std::vector<std::uint32_t> mesh_firsts;  // `first_triangles` on the host
  BvhStatistics statistics;
};

inline BinaryHierarchy view(const std::shared_ptr<Bvh::Content>& content) {
  if (!content) return {nullptr, nullptr, nullptr, 0};
  return {content->nodes.data(), content->triangles.data(), content->bounds.data(),
          static_cast<std::uint32_t>(content->nodes.size())};
}
inline MeshTable table(const std::shared_ptr<Bvh::Content>& content) {
  if (!content || content->mesh_firsts.empty()) return {nullptr, 0};
  return {content->first_triangles.data(), static_cast<std::uint32_t>(content->mesh_firsts.size() - 1)};
}

}  // namespace kerf::cuda
