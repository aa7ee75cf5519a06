// How many references a builder that splits before it builds must be allowed, so that its hierarchy has as
// many as another one.
#pragma once

#include <cstddef>

#include <kerf/build.hpp>

namespace workbench {

/// The number of references of the hierarchy that `options` describe, in the layout that is traced.
std::size_t count_references(const kerf::TriangleMesh& mesh, const kerf::BuildOptions& options);

/// The `presplit_references` with which the hierarchy that `options` describe, of `esc` or `evh`, has
/// `references` references, or as near to that as was found.
///
/// The parts of a triangle that end in one leaf are one reference of it. There are therefore fewer references
/// after the build than before it, and only a build can tell how many fewer. The secant method takes a few
/// builds. Some hierarchies cannot have as many references: further splitting only makes parts that end in
/// one leaf.
std::size_t presplit_references_for(std::size_t references, const kerf::TriangleMesh& mesh,
                                    kerf::BuildOptions options);

}  // namespace workbench
