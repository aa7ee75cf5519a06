// What options may be.
#pragma once

#include <kerf/build.hpp>

namespace kerf {

/// Throws `Error::invalid_argument`, which names the option that is out of its range.
void check_options(const BuildOptions& options);

}  // namespace kerf
