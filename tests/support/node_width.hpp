// Hierarchies with nodes of a width of one's choice, to be saved: only a machine whose nodes have that width
// can trace them.
#pragma once

#include <cstdint>

#include <kerf/kerf.hpp>

namespace kerf_tests {

/// The same hierarchy, converted.
kerf::Bvh with_node_width(const kerf::Bvh& bvh, std::uint32_t width);

/// As `build` makes it on such a machine.
kerf::Bvh build_with_node_width(const kerf::TriangleMesh& mesh, const kerf::BuildOptions& options,
                                std::uint32_t width);

}  // namespace kerf_tests
