#include "tree/validate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tree/polygon.hpp"

namespace kerf {
namespace {

class Validator {
 public:
  Validator(const BinaryTree& tree, const Geometry& geometry, std::size_t max_findings)
      : tree_(tree), geometry_(geometry), max_findings_(max_findings) {}

  // Walks from the root along the links. False if further checks cannot rely on them.
  bool check_nodes(std::size_t max_depth, std::size_t max_leaf_size) {
    std::vector<std::uint8_t> seen(tree_.nodes.size()), referenced(tree_.references.size());
    struct Entry {
      std::uint32_t node;
      std::size_t depth;
    };
    std::vector<Entry> stack{{0, 0}};
    seen[0] = 1;
    while (!stack.empty() && !full()) {
      const auto [index, depth] = stack.back();
      stack.pop_back();
      const BinaryNode& node = tree_.nodes[index];
      if (node.bounds.empty() || !is_finite(node.bounds.lower) || !is_finite(node.bounds.upper)) {
        report(index, "has an empty or infinite box");
      }
      if (node.is_leaf()) {
        if (depth > max_depth) report(index, "is a leaf at depth " + std::to_string(depth));
        if (node.count > max_leaf_size) report(index, "has " + std::to_string(node.count) + " references");
        check_leaf(index, referenced);
        continue;
      }
      if (node.left() <= index || std::size_t{node.left()} + 1 >= tree_.nodes.size()) {
        report(index, "has its children at " + std::to_string(node.left()) + ", before it or past the end");
        return false;
      }
      for (const std::uint32_t child : {node.left(), node.right()}) {
        if (seen[child]) {
          report(child, "has two parents");
          return false;
        }
        seen[child] = 1;
        if (!contains(node.bounds, tree_.nodes[child].bounds))
          report(child, "reaches out of its parent's box");
        stack.push_back({child, depth + 1});
      }
    }
    if (full()) return false;
    report_missing(seen, "node", "has no parent");
    report_missing(referenced, "reference", "is in no leaf");
    return findings_.empty();
  }

  void check_coverage() {
    std::vector<std::vector<std::uint32_t>> leaves(geometry_.triangle_count());
    for (std::uint32_t i = 0; i < tree_.nodes.size(); ++i) {
      const BinaryNode& node = tree_.nodes[i];
      for (std::uint32_t k = 0; k < node.count; ++k) leaves[tree_.references[node.first + k]].push_back(i);
    }
    for (std::uint32_t id = 0; id < leaves.size() && !full(); ++id) {
      const Triangle triangle = geometry_.triangle(id);
      if (is_degenerate(triangle)) continue;
      if (leaves[id].empty()) {
        findings_.push_back("triangle " + std::to_string(id) + " is in no leaf");
      } else if (!is_covered(triangle, leaves[id])) {
        findings_.push_back("triangle " + std::to_string(id) + " has a part in none of its leaves' boxes");
      }
    }
  }

  std::vector<std::string> findings() && { return std::move(findings_); }

 private:
  bool full() const { return findings_.size() >= max_findings_; }

  void report(std::uint32_t node, const std::string& what) {
    if (!full()) findings_.push_back("node " + std::to_string(node) + " " + what);
  }

  void report_missing(const std::vector<std::uint8_t>& seen, const std::string& kind,
                      const std::string& what) {
    for (std::size_t i = 0; i < seen.size() && !full(); ++i) {
      if (!seen[i]) findings_.push_back(kind + " " + std::to_string(i) + " " + what);
    }
  }

  void check_leaf(std::uint32_t index, std::vector<std::uint8_t>& referenced) {
    const BinaryNode& node = tree_.nodes[index];
    if (std::size_t{node.first} + node.count > tree_.references.size()) {
      return report(index, "has references past the end");
    }
    std::vector<std::uint32_t> ids(tree_.references.begin() + node.first,
                                   tree_.references.begin() + node.first + node.count);
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      if (referenced[k]) report(index, "shares reference " + std::to_string(k) + " with another leaf");
      referenced[k] = 1;
    }
    std::sort(ids.begin(), ids.end());
    if (ids.back() >= geometry_.triangle_count()) {
      report(index, "names triangle " + std::to_string(ids.back()) + ", which does not exist");
    }
    if (std::adjacent_find(ids.begin(), ids.end()) != ids.end()) report(index, "names a triangle twice");
  }

  // Subtracts one box after another from the triangle and looks at the rest.
  bool is_covered(const Triangle& triangle, const std::vector<std::uint32_t>& leaves) const {
    std::vector<Polygon> rest{Polygon(triangle)};
    for (const std::uint32_t leaf : leaves) {
      std::vector<Polygon> outside;
      for (Polygon& polygon : rest) subtract(std::move(polygon), tree_.nodes[leaf].bounds, outside);
      rest = std::move(outside);
    }
    const double threshold = hole_area(triangle);
    return std::all_of(rest.begin(), rest.end(), [&](const Polygon& p) { return p.area() <= threshold; });
  }

  static void subtract(Polygon polygon, const Box3f& box, std::vector<Polygon>& outside) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const auto& [position, sign] : {std::pair{box.lower[axis], -1.0}, {box.upper[axis], 1.0}}) {
        const double farthest = sign > 0.0 ? polygon.upper(axis) : -polygon.lower(axis);
        if (!(farthest > sign * position)) continue;
        Polygon part = clip(polygon, axis, position, -sign);
        if (part.area() > 0.0) outside.push_back(part);
        polygon = clip(polygon, axis, position, sign);
        if (polygon.count == 0) return;
      }
    }
  }

  // The area of a strip along the longest edge, 2^-40 of the largest coordinate wide. That is far above the
  // rounding of this test in double precision, and far below what a builder in single precision could lose.
  static double hole_area(const Triangle& t) {
    double largest = 0.0, longest = 0.0;
    for (const Vec3f& v : {t.v0, t.v1, t.v2}) {
      for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(double{v[axis]}));
    }
    const Box3f box = bounds_of(t);
    for (int axis = 0; axis < 3; ++axis) {
      longest = std::max(longest, double{box.upper[axis]} - box.lower[axis]);
    }
    return std::ldexp(largest * longest, -40);
  }

  const BinaryTree& tree_;
  const Geometry& geometry_;
  std::size_t max_findings_;
  std::vector<std::string> findings_;
};

}  // namespace

std::vector<std::string> validate(const BinaryTree& tree, const Geometry& geometry, std::size_t max_depth,
                                  std::size_t max_leaf_size, std::size_t max_findings) {
  Validator validator(tree, geometry, max_findings);
  if (tree.empty()) {
    if (!tree.references.empty()) return {"the tree has references but no node"};
    validator.check_coverage();
  } else if (validator.check_nodes(max_depth, max_leaf_size)) {
    validator.check_coverage();
  }
  return std::move(validator).findings();
}

}  // namespace kerf
