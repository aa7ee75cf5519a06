// A .kerf file in memory becomes a structure.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "structure.hpp"

namespace kerf {

/// What becomes of an image whose nodes are not as wide as this machine traces them.
enum class OtherWidth {
  convert,  ///< nodes that it can trace are made in new memory
  refuse,   ///< `Error::bad_format`
};

/// The structure in `image`, a whole file at an address that is a multiple of 64. It is not copied: the
/// structure's arrays lie in `image`, whose memory `owner` keeps. Throws `Error::bad_format` unless every
/// checksum is right and `check_structure` finds nothing.
std::shared_ptr<Structure> read_image(std::span<const std::byte> image, std::shared_ptr<const void> owner,
                                      OtherWidth other_width = OtherWidth::convert);

}  // namespace kerf
