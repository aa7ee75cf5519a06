// kerf itself, as the benchmark sees it.
#pragma once

#include <kerf/build.hpp>

#include "workbench/bench/peers/engine.hpp"

namespace workbench {

/// Traces ray by ray (mode "single") and by spans ("batch").
Engine kerf_engine(const kerf::BuildOptions& options, std::string version);

}  // namespace workbench
