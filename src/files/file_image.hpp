// A .kerf file as bytes in memory: written from a structure, and made a structure again once nothing in it
// can lead a traversal astray.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "files/file_header.hpp"
#include "structure.hpp"

namespace kerf {

/// The header of `structure`'s file. Nothing in it depends on the machine's speed or on the number of
/// threads.
FileHeader make_header(const Bvh::Structure& structure);

/// Checks all that a header can tell by itself, and that the file has as many bytes as it says, so that
/// memory can be taken for them. `bytes` are the first of the file, at least `sizeof(FileHeader)` unless the
/// file is shorter. Throws `Error::bad_format`, saying what is wrong.
FileHeader read_header(std::span<const std::byte> bytes, std::uint64_t file_bytes);

/// The structure that lies in `image`, a whole file at an address that is a multiple of 64. It shows `image`,
/// which `memory` keeps. Throws `Error::bad_format` unless every checksum is right and `check_structure`
/// finds nothing.
std::shared_ptr<Bvh::Structure> read_image(std::span<const std::byte> image,
                                           std::shared_ptr<const void> memory);

/// Throws `Error::bad_format` unless every path through the structure stays inside it and comes to an end:
/// links go to later nodes, each node is named once, leaves lie within the leaf data, coordinates are finite,
/// triangles have numbers of the meshes given, visiting orders name each child once.
void check_structure(const Bvh::Structure& structure);

}  // namespace kerf
