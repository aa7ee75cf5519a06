// Hierarchies with nodes of a width of one's choice.
#pragma once

#include <cstdint>
#include <memory>

#include "layout/change_width.hpp"
#include "structure.hpp"

namespace kerf_tests {

/// The same hierarchy with nodes of that width, to be saved: only a machine whose nodes have it can trace it.
inline kerf::Bvh with_node_width(const kerf::Bvh& bvh, std::uint32_t width) {
  auto changed = std::make_shared<kerf::Structure>(kerf::Structure::of(bvh));
  changed->wide = kerf::change_width(changed->wide, changed->statistics.triangles, width);
  return kerf::Structure::share(std::move(changed));
}

}  // namespace kerf_tests
