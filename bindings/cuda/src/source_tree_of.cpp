// The source of a device layout from what the library shows of its hierarchies.
#include <algorithm>
#include <limits>
#include <utility>

#include <kerf/inspect.hpp>
#include <kerf/layout.hpp>

#include "sort_by_key.hpp"
#include "source_tree.hpp"

namespace kerf::cuda {
namespace {

/// Between a wide node and its children, binary nodes stand where the
/// surface area heuristic finds them cheapest.
class LayoutReader {
 public:
  explicit LayoutReader(const Layout& layout) : layout_(layout) {}

  SourceTree read() {
    tree_.bounds = layout_.bounds;
    if (layout_.node_count == 0) return {};
    tree_.nodes.push_back({.box = layout_.bounds});
    expand(0, 0);
    return std::move(tree_);
  }

 private:
  struct Child {
    Box3f box;
    ChildLink link;
  };

  static Box3f merge(const Box3f& a, const Box3f& b) {
    Box3f box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = std::min(a.lower[axis], b.lower[axis]);
      box.upper[axis] = std::max(a.upper[axis], b.upper[axis]);
    }
    return box;
  }
  static double half_area(const Box3f& box) {
    const double x = double{box.upper.x} - box.lower.x, y = double{box.upper.y} - box.lower.y,
                 z = double{box.upper.z} - box.lower.z;
    return x * (y + z) + y * z;
  }

  void expand(std::uint32_t place, std::uint32_t node) {
    std::vector<Child> children;
    for (std::uint32_t slot = 0; slot < layout_.width; ++slot) {
      const Box3f box = layout_.box(node, slot);
      if (!box.empty()) children.push_back({box, layout_.child(node, slot)});
    }
    divide(place, children.data(), children.data() + children.size());
  }

  void divide(std::uint32_t place, Child* begin, Child* end) {
    if (end - begin == 1) return fill(place, *begin);
    const auto count = static_cast<std::size_t>(end - begin);
    std::vector<Child> order(begin, end), best;
    std::size_t best_left = count / 2;
    double best_cost = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      sort_by_key(order,
                  [&](const Child& child) { return double{child.box.lower[axis]} + child.box.upper[axis]; });
      std::vector<double> right(count);
      Box3f box;
      for (std::size_t i = count; i-- > 1;) {
        box = merge(box, order[i].box);
        right[i] = half_area(box) * weight(order, i, count);
      }
      box = {};
      for (std::size_t i = 1; i < count; ++i) {
        box = merge(box, order[i - 1].box);
        const double cost = half_area(box) * weight(order, 0, i) + right[i];
        if (cost >= best_cost) continue;
        best_cost = cost;
        best_left = i;
        best = order;
      }
    }
    if (!best.empty()) std::copy(best.begin(), best.end(), begin);
    const auto left = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes[place].first = left;
    tree_.nodes[place].count = 0;
    Box3f boxes[2];
    for (Child* child = begin; child != end; ++child) {
      Box3f& box = boxes[child - begin >= static_cast<std::ptrdiff_t>(best_left)];
      box = merge(box, child->box);
    }
    tree_.nodes.push_back({.box = boxes[0]});
    tree_.nodes.push_back({.box = boxes[1]});
    divide(left, begin, begin + best_left);
    divide(left + 1, begin + best_left, end);
  }

  // How much is below, as far as is known without a look: a node counts as sixteen.
  static double weight(const std::vector<Child>& children, std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i)
      sum += children[i].link.is_leaf() ? children[i].link.count() : 16.0;
    return sum;
  }

  void fill(std::uint32_t place, const Child& child) {
    tree_.nodes[place].box = child.box;
    if (!child.link.is_leaf()) return expand(place, child.link.node());
    tree_.nodes[place].first = static_cast<std::uint32_t>(tree_.references.size());
    tree_.nodes[place].count = child.link.count();
    for (std::uint32_t i = 0; i < child.link.count(); ++i) {
      const Triangle t = triangle_in(layout_.leaves, child.link, i);
      tree_.references.push_back(
          {.corner = {t.v0, t.v1, t.v2}, .number = triangle_id(layout_.leaves, child.link, i)});
    }
  }

  const Layout& layout_;
  SourceTree tree_;
};

}  // namespace

SourceTree source_of(const Layout& layout) {
  return LayoutReader(layout).read();
}

SourceTree source_of(const Tree& tree) {
  SourceTree source;
  source.nodes.reserve(tree.nodes().size());
  for (const BinaryNode& node : tree.nodes())
    source.nodes.push_back({.box = node.bounds, .first = node.first, .count = node.count});
  source.references.reserve(tree.references().size());
  for (const std::uint32_t id : tree.references()) {
    const Triangle t = tree.triangle(id);
    source.references.push_back({.corner = {t.v0, t.v1, t.v2}, .number = id});
  }
  if (!tree.nodes().empty()) source.bounds = tree.nodes()[0].bounds;
  return source;
}

std::vector<std::uint32_t> first_triangles_of(const Tree& tree) {
  // A triangle that is the first of its mesh begins it; meshes without triangles begin where the next one
  // does.
  std::vector<std::uint32_t> firsts;
  const auto count = static_cast<std::uint32_t>(tree.triangles());
  for (std::uint32_t id = 0; id < count;) {
    const PrimitiveId place = tree.locate(id);
    while (firsts.size() <= place.mesh) firsts.push_back(id - place.primitive);
    // The mesh's last triangle, by bisection.
    std::uint32_t in = id, behind = count;
    while (behind - in > 1) {
      const std::uint32_t middle = in + (behind - in) / 2;
      (tree.locate(middle).mesh == place.mesh ? in : behind) = middle;
    }
    id = behind;
  }
  firsts.push_back(count);
  return firsts;
}

}  // namespace kerf::cuda
