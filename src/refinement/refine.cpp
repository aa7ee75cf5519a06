#include "refinement/refine.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "base/seconds_since.hpp"
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

Schedule schedule_of(Quality quality) {
  if (quality == Quality::high) return {2, 0.1, 0.0};
  return {10, 1.0, 1e-4};
}

}  // namespace

void refine(BinaryTree& tree, const BuildOptions& options, const std::function<bool(float)>& progress) {
  // Where areas overflow they cannot be compared.
  if (tree.empty() || !std::isfinite(half_area(tree.nodes[0].bounds))) return;
  const Schedule schedule = schedule_of(options.quality);
  on_threads(options.threads, [&] {
    const auto start = std::chrono::steady_clock::now();
    std::size_t bytes = tree.bytes() + Reinsertion::bytes(tree.nodes.size(), schedule.fraction);
    {
      Reinsertion reinsertion(tree);
      bool has_time = true;
      for (unsigned round = 0; round < schedule.max_rounds && has_time; ++round) {
        const double gain = reinsertion.improve(schedule.fraction, [&](double done) {
          if (progress && !progress(static_cast<float>((round + done) / schedule.max_rounds)))
            raise(Error::cancelled, "the build was cancelled");
          has_time = seconds_since(start) < options.max_refinement_seconds;
          return has_time;
        });
        if (gain <= schedule.min_gain) break;
      }
    }
    bytes = std::max(bytes, tree.bytes() + tree.nodes.size() * sizeof(BinaryNode) +
                                tree.references.size() * sizeof(std::uint32_t));
    number_depth_first(tree);
    // Parts of a triangle may have come together anywhere.
    if (tree.min_divided_count != ~std::uint32_t{0}) tree.min_divided_count = 0;
    tree.build_peak_bytes = std::max(tree.build_peak_bytes, bytes);
  });
}

std::size_t refinement_memory_bound(std::size_t references, const BuildOptions& options) {
  if (options.quality == Quality::fast) return 0;
  return binary_tree_bytes(references) +
         std::max(binary_tree_bytes(references),
                  Reinsertion::bytes(2 * references, schedule_of(options.quality).fraction));
}

}  // namespace kerf
