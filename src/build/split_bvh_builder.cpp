#include "build/split_bvh_builder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "build/object_split.hpp"
#include "build/spatial_split.hpp"
#include "tree/metrics.hpp"

namespace kerf {
namespace {

static_assert(triangle_cost == 1.0, "costs of splits count triangles");

// The references of a node stand in the arena from `begin` to `end`; from there to `limit` is room for those
// that spatial splits below the node may make.
struct Range {
  std::uint32_t begin, end, limit;

  std::uint32_t count() const { return end - begin; }
  std::uint32_t slack() const { return limit - end; }
};

class Driver {
 public:
  Driver(const Geometry* geometry, std::vector<Reference>& arena, const BuildOptions& options)
      : geometry_(geometry), arena_(arena), options_(options) {}

  BinaryTree build(std::uint32_t count) {
    Box3f box;
    for (std::uint32_t i = 0; i < count; ++i) box = merge(box, arena_[i].bounds());
    root_half_area_ = half_area(box);
    tree_.nodes.resize(1);
    build_node(0, {0, count, static_cast<std::uint32_t>(arena_.size())}, 0);
    return std::move(tree_);
  }

 private:
  void build_node(std::uint32_t node, Range range, std::uint32_t depth) {
    const std::span<Reference> references(arena_.data() + range.begin, range.count());
    Box3f box, centroids;
    for (const Reference& reference : references) {
      box = merge(box, reference.bounds());
      centroids = merge(centroids, reference.lower + reference.upper);
    }
    tree_.nodes[node].bounds = box;
    if (range.count() == 1) return make_leaf(node, references);

    Range left, right;
    const bool nothing_to_part = centroids.lower == centroids.upper;
    if (nothing_to_part ||
        depth + static_cast<std::uint32_t>(std::bit_width(range.count())) >= max_tree_depth) {
      if (range.count() <= options_.max_leaf_size) return make_leaf(node, references);
      hand_down(range, range.count() / 2, range.count() - range.count() / 2, left, right);
    } else {
      const ObjectSplit object_split = find_object_split(references, centroids);
      SpatialSplit spatial_split;
      if (overlap_calls_for_spatial_split(object_split) && range.slack() > 0) {
        spatial_split = find_spatial_split(*geometry_, references, box, range.slack());
      }
      const auto leaf_is_cheapest = [&](float children_cost) {
        const float split_cost = static_cast<float>(inner_node_cost) * half_area(box) + children_cost;
        const float leaf_cost = half_area(box) * static_cast<float>(range.count());
        return range.count() <= options_.max_leaf_size && leaf_cost <= split_cost;
      };
      if (leaf_is_cheapest(std::min(object_split.cost, spatial_split.cost)))
        return make_leaf(node, references);

      std::uint32_t left_count = 0, right_count = 0;
      if (spatial_split.cost < object_split.cost) {
        const SpatialPartition counts =
            partition(*geometry_, references, arena_.data() + range.end, spatial_split);
        left_count = counts.left_count;
        right_count = counts.right_count;
      }
      if (left_count == 0 || right_count == 0) {  // no spatial split, or chopping left nothing on one side
        if (leaf_is_cheapest(object_split.cost)) return make_leaf(node, references);
        left_count = object_split.found() ? partition(references, object_split) : range.count() / 2;
        right_count = range.count() - left_count;
      }
      hand_down(range, left_count, right_count, left, right);
    }
    const auto child = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.resize(tree_.nodes.size() + 2);
    tree_.nodes[node].first = child;
    build_node(child, left, depth + 1);
    build_node(child + 1, right, depth + 1);
  }

  // Stich et al. 2009, section 4.5: where the children of the best object split hardly overlap, there is
  // little for a spatial split to win.
  bool overlap_calls_for_spatial_split(const ObjectSplit& split) const {
    if (geometry_ == nullptr) return false;
    if (!std::isfinite(root_half_area_)) return false;  // chopping could overflow: see math/clip.hpp
    if (!split.found()) return true;
    return half_area(intersect(split.left, split.right)) > options_.alpha * root_half_area_;
  }

  // Children share their parent's slack by their counts. The right one moves up to make room behind the left
  // one; since order means nothing, only as many references move as there is room to make.
  void hand_down(const Range& parent, std::uint32_t left_count, std::uint32_t right_count, Range& left,
                 Range& right) {
    const std::uint32_t used = parent.begin + left_count + right_count;
    const auto slack = static_cast<std::uint64_t>(parent.limit - used);
    const auto left_slack = static_cast<std::uint32_t>(slack * left_count / (left_count + right_count));
    left = {parent.begin, parent.begin + left_count, parent.begin + left_count + left_slack};
    const std::uint32_t moved = std::min(left_slack, right_count);
    std::copy_n(arena_.begin() + left.end, moved, arena_.begin() + (left.limit + right_count - moved));
    right = {left.limit, left.limit + right_count, parent.limit};
  }

  void make_leaf(std::uint32_t node, std::span<const Reference> references) {
    tree_.nodes[node].first = static_cast<std::uint32_t>(tree_.references.size());
    tree_.nodes[node].count = static_cast<std::uint32_t>(references.size());
    for (const Reference& reference : references) tree_.references.push_back(reference.primitive);
  }

  const Geometry* geometry_;  // null: object splits only
  std::vector<Reference>& arena_;
  const BuildOptions& options_;
  float root_half_area_ = 0.0f;
  BinaryTree tree_;
};

}  // namespace

BinaryTree build_object_split_tree(std::vector<Reference> references, const BuildOptions& options) {
  if (references.empty()) return {};
  return Driver(nullptr, references, options).build(static_cast<std::uint32_t>(references.size()));
}

BinaryTree build_split_tree(const Geometry& geometry, std::vector<Reference> references,
                            const BuildOptions& options) {
  if (references.empty()) return {};
  if (options.alpha >= 1.0f) return build_object_split_tree(std::move(references), options);
  const auto count = static_cast<std::uint32_t>(references.size());
  references.resize(
      static_cast<std::size_t>(static_cast<double>(count) * double{options.max_reference_ratio}));
  return Driver(&geometry, references, options).build(count);
}

}  // namespace kerf
