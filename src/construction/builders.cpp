#include "construction/builders.hpp"

#include <algorithm>
#include <array>
#include <iterator>

namespace kerf {

// A line for each builder, in the order in which comparisons show them: its enumerator, which is its name,
// too; what it does; its function, and the bound of its memory. A new builder is a file and a line.
#define KERF_BUILDERS(LINE)                                                                        \
  LINE(bvh, "object splits only", construct_split_tree, tree_memory_bound)                         \
  LINE(sbvh, "object and spatial splits (Stich, Friedrich & Dietrich 2009)", construct_split_tree, \
       tree_memory_bound)                                                                          \
  LINE(esc, "early split clipping (Ernst & Greiner 2007)", construct_esc, tree_memory_bound)       \
  LINE(evh, "edge volume heuristic (Dammertz & Keller 2008)", construct_evh, tree_memory_bound)

#define KERF_DECLARE(name, meaning, construct, memory_bound) \
  Construct construct;                                       \
  MemoryBound memory_bound;
KERF_BUILDERS(KERF_DECLARE)
#undef KERF_DECLARE

namespace {

#define KERF_ENTRY(name, meaning, construct, memory_bound) \
  {{Builder::name, #name, meaning}, construct, memory_bound},
constexpr BuilderEntry table[] = {KERF_BUILDERS(KERF_ENTRY)};
#undef KERF_ENTRY
#undef KERF_BUILDERS

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
