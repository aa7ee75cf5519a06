// Checksums of files: XXH3, 64 bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace kerf {

std::uint64_t checksum(std::span<const std::byte> bytes);

}  // namespace kerf
