#include "refinement/refine.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "base/seconds_since.hpp"
#include "refinement/expected_visits.hpp"
#include "refinement/ray_flux.hpp"
#include "refinement/reinsertion.hpp"

namespace kerf {
namespace {

// How often and for which part of the nodes a better place is looked for. The tenth with the largest boxes
// has most of what there is to gain, for a fifth to four fifths of a build's time; every round gains a
// fraction of the one before it. docs/decisions/0091 has the figures.
struct Schedule {
  unsigned max_rounds;
  double fraction;
  double min_gain;  // a round that gains less is the last
};

// By sample rays a box takes thirty times as long to measure, and the last rounds gain what is within the
// error of measuring.
Schedule schedule_of(const BuildOptions& options) {
  if (options.quality == Quality::fast) return {0, 0.0, 0.0};
  if (options.quality == Quality::high) return {2, 0.1, 0.0};
  return {10, 1.0, options.sample_rays.empty() ? 1e-4 : 2e-3};
}

std::size_t bytes_of_counts(std::size_t nodes) {
  return nodes * sizeof(std::uint32_t);
}

class Refinement {
 public:
  Refinement(BinaryTree& tree, const BuildOptions& options, const std::function<bool(float)>& progress)
      : tree_(tree), options_(options), schedule_(schedule_of(options)), progress_(progress) {}

  void run(std::span<const Ray> ways) {
    if (schedule_.max_rounds != 0) {
      move_subtrees(ways);
      number_anew(ways);
    }
    if (!ways.empty()) {
      expect_visits(tree_, ways);
      note(tree_.bytes() + ways.size_bytes() + bytes_of_counts(tree_.nodes.size()));
    }
  }

 private:
  void tell(double rounds) const {
    if (progress_ && !progress_(static_cast<float>(rounds / schedule_.max_rounds)))
      raise(Error::cancelled, "the build was cancelled");
  }

  void note(std::size_t bytes) { tree_.build_peak_bytes = std::max(tree_.build_peak_bytes, bytes); }

  void move_subtrees(std::span<const Ray> ways) {
    const auto start = std::chrono::steady_clock::now();
    note(tree_.bytes() + Reinsertion::bytes(tree_.nodes.size(), schedule_.fraction, !ways.empty()) +
         (ways.empty() ? 0 : ways.size_bytes() + RayFlux::bytes()));
    const Box3f& scene = tree_.nodes[0].bounds;
    std::optional<RayFlux> flux;
    if (!ways.empty() && half_area(scene) >= std::numeric_limits<float>::min()) flux.emplace(scene, ways);
    Reinsertion reinsertion(tree_, flux ? &*flux : nullptr);
    bool has_time = true;
    for (unsigned round = 0; round < schedule_.max_rounds && has_time; ++round) {
      const double gain = reinsertion.improve(schedule_.fraction, [&](double done) {
        tell(round + done);
        has_time = seconds_since(start) < options_.max_refinement_seconds;
        return has_time;
      });
      if (gain <= schedule_.min_gain) break;
    }
  }

  void number_anew(std::span<const Ray> ways) {
    note(tree_.bytes() + tree_.nodes.size() * sizeof(BinaryNode) +
         tree_.references.size() * sizeof(std::uint32_t) + ways.size_bytes());
    number_depth_first(tree_);
    // Parts of a triangle may have come together anywhere.
    if (tree_.min_divided_count != ~std::uint32_t{0}) tree_.min_divided_count = 0;
  }

  BinaryTree& tree_;
  const BuildOptions& options_;
  const Schedule schedule_;
  const std::function<bool(float)>& progress_;
};

}  // namespace

void refine(BinaryTree& tree, std::span<const Ray> ways, const BuildOptions& options,
            const std::function<bool(float)>& progress) {
  // Where areas overflow they cannot be compared.
  if (tree.empty() || !std::isfinite(half_area(tree.nodes[0].bounds))) return;
  on_threads(options.threads, [&] { Refinement(tree, options, progress).run(ways); });
}

std::size_t refinement_memory_bound(std::size_t references, std::size_t ways, const BuildOptions& options) {
  const std::size_t nodes = 2 * references;
  const Schedule schedule = schedule_of(options);
  std::size_t beside_tree = 0;
  if (schedule.max_rounds != 0) {
    beside_tree =
        std::max(binary_tree_bytes(references), Reinsertion::bytes(nodes, schedule.fraction, ways != 0) +
                                                    (ways != 0 ? RayFlux::bytes() : 0));
  }
  if (ways != 0) beside_tree = std::max(beside_tree, nodes * sizeof(float) + bytes_of_counts(nodes));
  return beside_tree == 0 ? 0 : binary_tree_bytes(references) + beside_tree + ways * sizeof(Ray);
}

}  // namespace kerf
