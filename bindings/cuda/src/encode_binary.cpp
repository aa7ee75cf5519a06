#include <bit>

#include "encode.hpp"

namespace kerf::cuda {

SceneBounds scene_bounds(const Box3f& box) {
  return {{box.lower.x, box.lower.y, box.lower.z}, {box.upper.x, box.upper.y, box.upper.z}};
}

DeviceTriangle device_triangle(const SourceTriangle& triangle) {
  DeviceTriangle result;
  for (int i = 0; i < 3; ++i) {
    const Vec3f& corner = triangle.corner[static_cast<std::size_t>(i)];
    result.corner[i] = {as_bits(corner.x), as_bits(corner.y), as_bits(corner.z), triangle.number};
  }
  return result;
}

namespace {

class BinaryEncoder {
 public:
  BinaryEncoder(const SourceTree& tree, EncodedBinary& out) : tree_(tree), out_(out) {}

  // The link to node `number`, written with all below it, depth first.
  std::uint32_t encode(std::uint32_t number, std::uint32_t parent) {
    const SourceNode& node = tree_.nodes[number];
    if (node.count != 0) return leaf_link(node.first, node.count);
    return pair(node.first, node.first + 1, parent);
  }

  std::uint32_t pair(std::uint32_t left, std::uint32_t right, std::uint32_t parent) {
    const auto place = out_.nodes.size();
    PairNode& node = out_.nodes.emplace_back();
    const Box3f &a = tree_.nodes[left].box, &b = tree_.nodes[right].box;
    node = {{a.lower.x, a.upper.x, a.lower.y, a.upper.y},
            {b.lower.x, b.upper.x, b.lower.y, b.upper.y},
            {a.lower.z, a.upper.z, b.lower.z, b.upper.z},
            {},
            parent,
            0};
    const auto number = static_cast<std::uint32_t>(place);
    const std::uint32_t first = encode(left, number);
    const std::uint32_t second = left == right ? first : encode(right, number);
    out_.nodes[place].link[0] = first;
    out_.nodes[place].link[1] = second;
    return static_cast<std::uint32_t>(place);
  }

 private:
  const SourceTree& tree_;
  EncodedBinary& out_;
};

}  // namespace

EncodedBinary encode_binary(const SourceTree& tree) {
  EncodedBinary out;
  out.bounds = scene_bounds(tree.bounds);
  out.triangles.reserve(tree.references.size());
  for (const SourceTriangle& triangle : tree.references) out.triangles.push_back(device_triangle(triangle));
  if (tree.nodes.empty()) return out;
  out.nodes.reserve(tree.nodes.size() / 2 + 1);
  BinaryEncoder encoder(tree, out);
  // A single leaf stands twice in its root, which asks for two children.
  if (tree.nodes[0].count != 0)
    encoder.pair(0, 0, no_link);
  else
    encoder.encode(0, no_link);
  return out;
}

}  // namespace kerf::cuda
