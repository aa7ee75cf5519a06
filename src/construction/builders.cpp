#include "construction/builders.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include "construction/presplit/esc.hpp"
#include "construction/presplit/evh.hpp"
#include "construction/sbvh/parallel_build.hpp"

namespace kerf {
namespace {

// In the order in which comparisons show them.
constexpr BuilderEntry table[] = {
    {{Builder::bvh, "bvh", "object splits only"}, construct_split_tree, tree_memory_bound},
    {{Builder::sbvh, "sbvh", "object and spatial splits (Stich, Friedrich & Dietrich 2009)"},
     construct_split_tree,
     tree_memory_bound},
    {{Builder::esc, "esc", "early split clipping (Ernst & Greiner 2007)"}, construct_esc, tree_memory_bound},
    {{Builder::evh, "evh", "edge volume heuristic (Dammertz & Keller 2008)"},
     construct_evh,
     tree_memory_bound},
};

}  // namespace

const BuilderEntry* find_builder(Builder builder) {
  const auto entry =
      std::find_if(std::begin(table), std::end(table),
                   [builder](const BuilderEntry& candidate) { return candidate.info.builder == builder; });
  return entry == std::end(table) ? nullptr : entry;
}

std::span<const BuilderInfo> builders() {
  static constexpr auto infos = [] {
    std::array<BuilderInfo, std::size(table)> all{};
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = table[i].info;
    return all;
  }();
  return infos;
}

}  // namespace kerf
