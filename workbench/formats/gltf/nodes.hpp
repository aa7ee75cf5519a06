// The nodes of a glTF file and where they are.
#pragma once

#include <cstdint>
#include <vector>

#include "workbench/formats/gltf/document.hpp"
#include "workbench/formats/gltf/transform.hpp"

namespace workbench::gltf {

struct Nodes {
  std::vector<Transform> transforms;    ///< of each node, from its own space to that of the scene
  std::vector<std::uint64_t> in_scene;  ///< the numbers of those that the scene shows
  std::size_t hidden = 0;               ///< left out, as KHR_node_visibility says
};

/// Throws unless the nodes form trees. The scene is the one that the file names, else the first; in a file
/// without scenes all nodes are shown.
Nodes read_nodes(const Document& document);

}  // namespace workbench::gltf
