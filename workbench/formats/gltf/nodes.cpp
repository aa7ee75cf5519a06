#include "workbench/formats/gltf/nodes.hpp"

#include <limits>
#include <string>

namespace workbench::gltf {
namespace {

constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();

Transform transform_of(const Document& document, const Object& node) {
  if (const auto matrix = document.find_numbers<16>(node, "matrix")) return from_columns(*matrix);
  return from_parts(document.find_numbers<3>(node, "translation").value_or(std::array<double, 3>{0, 0, 0}),
                    document.find_numbers<4>(node, "rotation").value_or(std::array<double, 4>{0, 0, 0, 1}),
                    document.find_numbers<3>(node, "scale").value_or(std::array<double, 3>{1, 1, 1}));
}

// The numbers of nodes in a list, all of which exist.
std::vector<std::uint64_t> node_numbers(const Document& document, const Object& object, const char* key) {
  std::vector<std::uint64_t> numbers;
  for (const Json& value : document.list(object, key)) {
    numbers.push_back(document.to_whole(value, object.name));
    document.item("nodes", numbers.back(), object.name);
  }
  return numbers;
}

bool is_hidden(const Document& document, const Object& node) {
  const auto visibility = document.find_extension(node, "KHR_node_visibility");
  return visibility && !document.find_flag(*visibility, "visible", true);
}

}  // namespace

Nodes read_nodes(const Document& document) {
  const std::uint64_t count = document.count("nodes");
  std::vector<std::vector<std::uint64_t>> children(count);
  std::vector<std::uint64_t> parents(count, none);
  for (std::uint64_t i = 0; i < count; ++i) {
    const Object node = document.item("nodes", i, "nodes");
    children[i] = node_numbers(document, node, "children");
    for (const std::uint64_t child : children[i]) {
      if (parents[child] != none)
        document.raise("nodes[{}] has two parents, {} and {}", child, parents[child], i);
      parents[child] = i;
    }
  }

  // From parents to children; what is on no way from a root is its own ancestor.
  Nodes nodes;
  nodes.transforms.resize(count);
  std::vector<std::uint64_t> order;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (parents[i] == none) order.push_back(i);
  }
  std::vector<bool> is_seen(count, false);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::uint64_t i = order[k];
    const Transform own = transform_of(document, document.item("nodes", i, "nodes"));
    nodes.transforms[i] = parents[i] == none ? own : nodes.transforms[parents[i]] * own;
    is_seen[i] = true;
    for (const std::uint64_t child : children[i]) order.push_back(child);
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!is_seen[i]) document.raise("nodes[{}] is its own ancestor", i);
  }

  std::vector<std::uint64_t> shown;
  if (document.count("scenes") == 0) {
    for (std::uint64_t i = 0; i < count; ++i) {
      if (parents[i] == none) shown.push_back(i);
    }
  } else {
    const std::uint64_t scene = document.find_whole(document.root(), "scene").value_or(0);
    shown = node_numbers(document, document.item("scenes", scene, "scene"), "nodes");
  }
  std::vector<bool> is_shown(count, false);
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const std::uint64_t i = shown[k];
    if (is_shown[i]) document.raise("the scene shows nodes[{}] twice", i);
    is_shown[i] = true;
    if (is_hidden(document, document.item("nodes", i, "nodes"))) {
      ++nodes.hidden;
      continue;
    }
    nodes.in_scene.push_back(i);
    for (const std::uint64_t child : children[i]) shown.push_back(child);
  }
  return nodes;
}

}  // namespace workbench::gltf
