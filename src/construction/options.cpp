#include "construction/options.hpp"

#include <kerf/layout.hpp>

#include "base/raise.hpp"
#include "construction/builders.hpp"

namespace kerf {

void check_options(const BuildOptions& options) {
  if (!(options.alpha >= 0.0f && options.alpha <= 1.0f)) {
    raise(Error::invalid_argument, "alpha is %g, but must be from 0 to 1", double{options.alpha});
  }
  if (!(options.max_reference_ratio >= 1.0f && options.max_reference_ratio <= 16.0f)) {
    raise(Error::invalid_argument, "max_reference_ratio is %g, but must be from 1 to 16",
          double{options.max_reference_ratio});
  }
  if (options.max_leaf_size < 1 || options.max_leaf_size > max_leaf_triangles) {
    raise(Error::invalid_argument, "max_leaf_size is %u, but must be from 1 to %u", options.max_leaf_size,
          max_leaf_triangles);
  }
  if (options.non_finite != NonFinite::refuse && options.non_finite != NonFinite::skip) {
    raise(Error::invalid_argument, "non_finite is %d, which means nothing",
          static_cast<int>(options.non_finite));
  }
  if (options.quality != Quality::fast && options.quality != Quality::high &&
      options.quality != Quality::best) {
    raise(Error::invalid_argument, "quality is %d, which means nothing", static_cast<int>(options.quality));
  }
  if (!(options.max_refinement_seconds >= 0.0)) {
    raise(Error::invalid_argument, "max_refinement_seconds is %g, but must not be negative",
          options.max_refinement_seconds);
  }
  if (find_builder(options.builder) == nullptr) {
    raise(Error::invalid_argument, "builder is %d, which names none", static_cast<int>(options.builder));
  }
}

}  // namespace kerf
