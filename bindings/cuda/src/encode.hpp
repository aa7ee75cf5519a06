// From a binary tree to what kernels traverse.
#pragma once

#include <vector>

#include "binary_layout.hpp"
#include "source_tree.hpp"

namespace kerf::cuda {

struct EncodedBinary {
  std::vector<PairNode> nodes;
  std::vector<DeviceTriangle> triangles;
  SceneBounds bounds;
};

DeviceTriangle device_triangle(const SourceTriangle& triangle);
SceneBounds scene_bounds(const Box3f& box);

/// Leaves of up to eight references stay as they are.
EncodedBinary encode_binary(const SourceTree& tree);

}  // namespace kerf::cuda
