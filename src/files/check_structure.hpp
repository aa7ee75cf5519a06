// Whether traversal may trust what a file holds.
#pragma once

#include <cstdint>
#include <span>

#include "files/file_header.hpp"
#include "layout/wide_bvh.hpp"

namespace kerf {

/// Throws `Error::bad_format` unless every path through `wide` stays inside it and comes to an end: links go
/// to later nodes, each node has one link to it, leaves lie within the leaf data, coordinates are finite,
/// triangles have numbers of the meshes, and visiting orders name each child once. `first_triangles` and
/// `header` are those of the same file.
void check_structure(const WideBvh& wide, std::span<const std::uint32_t> first_triangles,
                     const FileHeader& header);

}  // namespace kerf
