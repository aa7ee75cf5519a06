// With which instruction set a peer is compared: the fastest one that is not above kerf's own.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "workbench/bench/bench.hpp"

namespace workbench {

/// Those of `isas`, which Embree supports here (`embree_isas`), that have no wider vectors and no newer
/// instructions than kerf's `target` (`kerf::instruction_set`). The first of `isas` is always among them.
std::vector<std::string> isas_up_to(std::string_view target, std::span<const std::string> isas);

/// The one of `isas` with which `embree-high` traces `scene` fastest: by the geometric mean of its speed over
/// the types of rays, measured interleaved on a fraction of the rays. `isas` must not be empty.
std::string fastest_isa(const Scene& scene, std::span<const std::string> isas, const BenchOptions& options);

}  // namespace workbench
