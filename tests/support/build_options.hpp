// Builds that tests ask for.
#pragma once

#include <kerf/build.hpp>

namespace kerf {

/// A spatial split is tried at every node and given room: the most duplicated references that a build makes.
inline BuildOptions spatial_splits_everywhere() {
  BuildOptions options;
  options.alpha = 0.0f;
  options.max_reference_ratio = 3.0f;
  options.max_leaf_size = 2;
  return options;
}

}  // namespace kerf
