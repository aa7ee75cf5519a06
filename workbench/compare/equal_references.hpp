// How many references a builder that splits before it builds must be allowed, for its hierarchy to have as
// many as another.
#pragma once

#include <cstddef>

#include <kerf/build.hpp>

#include "tree/geometry.hpp"

namespace workbench {

/// The references of the hierarchy that `options` describe, in the layout that is traced.
std::size_t count_references(const kerf::Geometry& geometry, const kerf::BuildOptions& options);

/// The `presplit_references` with which the hierarchy that `options` describe, of `esc` or `evh`, has
/// `references` references, or as near to that as was found. Parts of a triangle that come to one leaf are
/// one reference of it, so that there are fewer in the end than were made before the build; how many fewer,
/// only a build can tell. The secant rule takes a few. Some hierarchies cannot have as many: further
/// splitting makes nothing but parts that end in one leaf.
std::size_t presplit_references_for(std::size_t references, const kerf::Geometry& geometry,
                                    kerf::BuildOptions options);

}  // namespace workbench
