#include <algorithm>
#include <cmath>
#include <utility>

#include "../src/encode.hpp"
#include "wide_layout.hpp"

namespace kerf::cuda {
namespace {

constexpr std::size_t width = 8;

// A grid no finer than this: a step times an inverse of a direction must not leave the range of a float.
constexpr int min_exponent = -60;

double half_area(const Box3f& box) {
  const double x = double{box.upper.x} - box.lower.x, y = double{box.upper.y} - box.lower.y,
               z = double{box.upper.z} - box.lower.z;
  return x * y + y * z + z * x;
}

double twice_center(const Box3f& box, int axis) {
  return double{box.lower[axis]} + box.upper[axis];
}

class WideEncoder {
 public:
  WideEncoder(const SourceTree& tree, EncodedWide& out) : tree_(tree), out_(out) {}

  // Everything below `numbers`, as the node at `place`.
  void encode(std::size_t place, std::vector<std::uint32_t> numbers) {
    expand(numbers);
    const std::vector<std::uint32_t> slots = assigned(numbers);
    CompressedNode node{};
    set_planes(node, numbers, slots);
    node.first_node = static_cast<std::uint32_t>(out_.nodes.size());
    node.first_triangle = static_cast<std::uint32_t>(out_.triangles.size());
    std::vector<std::uint32_t> below;
    for (std::size_t slot = 0; slot < width; ++slot) {
      const auto child = std::find(slots.begin(), slots.end(), slot);
      if (child == slots.end()) continue;
      const std::uint32_t number = numbers[static_cast<std::size_t>(child - slots.begin())];
      const SourceNode& source = tree_.nodes[number];
      if (source.count == 0) {
        node.inner = static_cast<std::uint8_t>(node.inner | (1u << slot));
        node.kind[slot] = 1;
        below.push_back(number);
        continue;
      }
      const auto offset = static_cast<std::uint32_t>(out_.triangles.size()) - node.first_triangle;
      node.kind[slot] = wide_leaf(offset, source.count);
      for (std::uint32_t i = 0; i < source.count; ++i)
        out_.triangles.push_back(device_triangle(tree_.references[source.first + i]));
    }
    out_.nodes[place] = node;
    out_.nodes.resize(out_.nodes.size() + below.size());
    for (std::size_t i = 0; i < below.size(); ++i)
      encode(node.first_node + i, {tree_.nodes[below[i]].first, tree_.nodes[below[i]].first + 1});
  }

 private:
  // Puts the children of the largest node in its place, while there is room.
  void expand(std::vector<std::uint32_t>& numbers) const {
    while (numbers.size() < width) {
      auto largest = numbers.end();
      for (auto i = numbers.begin(); i != numbers.end(); ++i) {
        if (tree_.nodes[*i].count != 0) continue;
        if (largest == numbers.end() || half_area(tree_.nodes[*i].box) > half_area(tree_.nodes[*largest].box))
          largest = i;
      }
      if (largest == numbers.end()) return;
      const std::uint32_t left = tree_.nodes[*largest].first;
      *largest = left;
      numbers.push_back(left + 1);
    }
  }

  // Each child's slot. A ray that runs along all axes visits slot 7 first, and the slot with bit a clear
  // before its neighbour where it runs against axis a: the child and the slot that match best are taken
  // first.
  std::vector<std::uint32_t> assigned(const std::vector<std::uint32_t>& numbers) const {
    double center[3];
    for (int axis = 0; axis < 3; ++axis) {
      const auto [lower, upper] = range(numbers, axis);
      center[axis] = double{lower} + upper;
    }
    std::vector<std::uint32_t> slots(numbers.size(), width);
    bool taken[width] = {};
    for (std::size_t round = 0; round < numbers.size(); ++round) {
      double best = -1.0;
      std::size_t best_child = 0, best_slot = 0;
      bool first = true;
      for (std::size_t child = 0; child < numbers.size(); ++child) {
        if (slots[child] != width) continue;
        for (std::size_t slot = 0; slot < width; ++slot) {
          if (taken[slot]) continue;
          double match = 0.0;
          for (int axis = 0; axis < 3; ++axis) {
            const double off = twice_center(tree_.nodes[numbers[child]].box, axis) - center[axis];
            match += ((slot >> axis) & 1) != 0 ? -off : off;
          }
          if (!first && !(match > best)) continue;
          first = false;
          best = match;
          best_child = child;
          best_slot = slot;
        }
      }
      slots[best_child] = static_cast<std::uint32_t>(best_slot);
      taken[best_slot] = true;
    }
    return slots;
  }

  // From the lowest to the highest coordinate of the nodes' boxes.
  std::pair<float, float> range(const std::vector<std::uint32_t>& numbers, int axis) const {
    const Box3f& first = tree_.nodes[numbers[0]].box;
    std::pair<float, float> result{first.lower[axis], first.upper[axis]};
    for (const std::uint32_t number : numbers) {
      result.first = std::min(result.first, tree_.nodes[number].box.lower[axis]);
      result.second = std::max(result.second, tree_.nodes[number].box.upper[axis]);
    }
    return result;
  }

  void set_planes(CompressedNode& node, const std::vector<std::uint32_t>& numbers,
                  const std::vector<std::uint32_t>& slots) const {
    for (int axis = 0; axis < 3; ++axis) {
      const auto [lower, upper] = range(numbers, axis);
      int exponent = min_exponent;
      const double extent = double{upper} - lower;
      while (std::ceil(std::ldexp(extent, -exponent)) > 255.0) ++exponent;
      const auto a = static_cast<std::size_t>(axis);
      node.origin[a] = lower;
      node.exponent[a] = static_cast<std::uint8_t>(exponent + 127);
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        const Box3f& box = tree_.nodes[numbers[i]].box;
        const double from = std::floor(std::ldexp(double{box.lower[axis]} - lower, -exponent));
        const double to = std::ceil(std::ldexp(double{box.upper[axis]} - lower, -exponent));
        node.plane[2 * a][slots[i]] = static_cast<std::uint8_t>(from);
        node.plane[2 * a + 1][slots[i]] = static_cast<std::uint8_t>(to);
      }
    }
  }

  const SourceTree& tree_;
  EncodedWide& out_;
};

}  // namespace

EncodedWide encode_wide(const SourceTree& given) {
  const SourceTree tree = with_small_leaves(given, max_wide_leaf);
  EncodedWide out;
  out.bounds = scene_bounds(tree.bounds);
  if (tree.nodes.empty()) return out;
  out.nodes.resize(1);
  WideEncoder(tree, out).encode(0, {0});
  return out;
}

}  // namespace kerf::cuda
