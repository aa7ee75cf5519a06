#include <kerf/inspect.hpp>

namespace kerf {

std::span<const BuilderInfo> builders() {
  static constexpr BuilderInfo table[] = {
      {Builder::bvh, "bvh", "object splits only"},
      {Builder::sbvh, "sbvh", "object and spatial splits (Stich, Friedrich & Dietrich 2009)"},
      {Builder::esc, "esc", "early split clipping (Ernst & Greiner 2007)"},
      {Builder::evh, "evh", "edge volume heuristic (Dammertz & Keller 2008)"},
  };
  return table;
}

}  // namespace kerf
