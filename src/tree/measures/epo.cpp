// Each triangle is clipped down the tree. Its area in the boxes of nodes that do not have it below them
// counts. Where so many boxes overlap that this would take the square of the number of triangles, as many
// triangles as a bound on the visits of nodes allows stand for all.
#include "tree/measures/epo.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include <kerf/inspect.hpp>

#include "base/parallel.hpp"
#include "base/scratch_pool.hpp"
#include "tree/polygon.hpp"

namespace kerf {
namespace {

// The leaves that reference each triangle, and the parents of all nodes.
struct LeavesOfTriangles {
  std::vector<std::uint32_t> first;   // of each triangle, its place in `leaves`; one more ends the last
  std::vector<std::uint32_t> leaves;  // node numbers
  std::vector<std::uint32_t> parent;  // of each node; the root is its own

  LeavesOfTriangles(const BinaryTree& tree, std::size_t triangle_count)
      : first(triangle_count + 1), leaves(tree.references.size()), parent(tree.nodes.size()) {
    for (const std::uint32_t id : tree.references) ++first[id + 1];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < tree.nodes.size(); ++i) {
      const BinaryNode& node = tree.nodes[i];
      if (node.is_leaf()) {
        for (std::uint32_t k = 0; k < node.count; ++k) leaves[next[tree.references[node.first + k]]++] = i;
      } else {
        parent[node.left()] = parent[node.right()] = i;
      }
    }
  }
};

// The nodes that have the current triangle in their subtree are stamped with its number plus one.
using Stamps = std::vector<std::uint32_t>;

// The triangles in an order whose beginnings are spread evenly over all of them: multiples of a number next
// to the golden section that has no divisor in common with their count.
class SpreadOrder {
 public:
  explicit SpreadOrder(std::uint32_t count)
      : count_(count), step_(static_cast<std::uint32_t>(0.6180339887498949 * count) | 1u) {
    while (std::gcd(step_, count_) != 1) ++step_;
  }
  std::uint32_t operator[](std::uint32_t i) const {
    return static_cast<std::uint32_t>(std::uint64_t{step_} * i % count_);
  }

 private:
  std::uint32_t count_, step_;
};

class Overlap {
 public:
  Overlap(const BinaryTree& tree, const Geometry& geometry)
      : tree_(tree),
        geometry_(geometry),
        owners_(tree, geometry.triangle_count()),
        order_(static_cast<std::uint32_t>(geometry.triangle_count())) {}

  Estimate measure(double visits_per_level) {
    const auto count = static_cast<std::uint32_t>(geometry_.triangle_count());
    const double max_visits = visits_per_level * count * std::bit_width(count);
    std::uint32_t done = std::min(first_round, count);
    Sums sums = of_triangles(0, done);
    while (done < count) {  // rounds of doubling size, the last as large as the bound allows
      const double affordable =
          max_visits * done / static_cast<double>(std::max<std::uint64_t>(sums.visits, 1));
      const auto end = static_cast<std::uint32_t>(std::min({affordable, 2.0 * done, 1.0 * count}));
      if (end <= done) break;
      sums = sums + of_triangles(done, end);
      done = end;
    }
    if (!(sums.surface > 0.0)) return {};
    const double value = sums.overlap / sums.surface;
    if (done == count) return {value, 0.0};
    // Of a ratio of two means, from a sample without replacement (Cochran 1977, "Sampling Techniques", 6.4).
    const double squares =
        sums.overlap_squares - 2.0 * value * sums.products + value * value * sums.surface_squares;
    const double share = static_cast<double>(done) / count, n = done;
    return {value, std::sqrt(std::max(0.0, (1.0 - share) * n / (n - 1.0) * squares)) / sums.surface};
  }

 private:
  static constexpr std::uint32_t first_round = 16;

  struct Sums {
    double surface = 0.0;
    double overlap = 0.0;  // cost times area
    double surface_squares = 0.0, products = 0.0, overlap_squares = 0.0;
    std::uint64_t visits = 0;

    friend Sums operator+(const Sums& a, const Sums& b) {
      return {a.surface + b.surface,
              a.overlap + b.overlap,
              a.surface_squares + b.surface_squares,
              a.products + b.products,
              a.overlap_squares + b.overlap_squares,
              a.visits + b.visits};
    }
  };

  // Of places `begin .. end - 1` of the order.
  Sums of_triangles(std::uint32_t begin, std::uint32_t end) {
    // The grain fixes how the sums are divided, so that they are the same for any number of threads.
    const std::uint32_t grain = std::clamp((end - begin) / 16, 1u, 256u);
    return parallel_sum<Sums>(end - begin, grain, [this, begin](const auto& range) {
      Sums sums;
      const auto stamps = stamps_.borrow([this] { return Stamps(tree_.nodes.size(), 0); });
      for (std::uint32_t i = range.begin(); i != range.end(); ++i)
        sums = sums + of_triangle(order_[begin + i], *stamps);
      return sums;
    });
  }

  Sums of_triangle(std::uint32_t id, Stamps& stamps) const {
    Sums sums;
    if (owners_.first[id] == owners_.first[id + 1]) return sums;
    const std::uint32_t stamp = id + 1;
    for (std::uint32_t i = owners_.first[id]; i < owners_.first[id + 1]; ++i) {
      for (std::uint32_t n = owners_.leaves[i]; stamps[n] != stamp; n = owners_.parent[n]) stamps[n] = stamp;
    }
    const Polygon polygon(geometry_.triangle(id));
    const double surface = polygon.area(), overlap = below(0, polygon, surface, stamp, stamps, sums.visits);
    sums.surface = surface;
    sums.overlap = overlap;
    sums.surface_squares = surface * surface;
    sums.products = surface * overlap;
    sums.overlap_squares = overlap * overlap;
    return sums;
  }

  double below(std::uint32_t index, const Polygon& whole, double whole_area, std::uint32_t stamp,
               const Stamps& stamps, std::uint64_t& visits) const {
    ++visits;
    const BinaryNode& node = tree_.nodes[index];
    if (is_inside(whole, node.bounds)) return inside(index, whole, whole_area, stamp, stamps, visits);
    const Polygon part = clip(whole, node.bounds);
    return inside(index, part, part.area(), stamp, stamps, visits);
  }

  // The same for the part that lies in the node's box.
  double inside(std::uint32_t index, const Polygon& part, double area, std::uint32_t stamp,
                const Stamps& stamps, std::uint64_t& visits) const {
    if (area == 0.0) return 0.0;
    const BinaryNode& node = tree_.nodes[index];
    const double cost = node.is_leaf() ? triangle_cost * node.count : inner_node_cost;
    double overlap = stamps[index] == stamp ? 0.0 : cost * area;
    if (!node.is_leaf()) {
      overlap += below(node.left(), part, area, stamp, stamps, visits) +
                 below(node.right(), part, area, stamp, stamps, visits);
    }
    return overlap;
  }

  const BinaryTree& tree_;
  const Geometry& geometry_;
  LeavesOfTriangles owners_;
  SpreadOrder order_;
  ScratchPool<Stamps> stamps_;
};

}  // namespace

Estimate end_point_overlap(const BinaryTree& tree, const Geometry& geometry, double visits_per_level) {
  if (tree.empty()) return {};
  return Overlap(tree, geometry).measure(visits_per_level);
}

}  // namespace kerf
