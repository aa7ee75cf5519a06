#include "files/checksum.hpp"

#define XXH_INLINE_ALL  // compiled in: nothing to link, nothing for users of the library to install
#include <xxhash.h>

namespace kerf {

std::uint64_t checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

}  // namespace kerf
