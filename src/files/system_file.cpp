// What does not depend on the system.
#include "files/system_file.hpp"

#include "base/parallel.hpp"

namespace kerf {
namespace {

// Threads that read a file together take about this many bytes at a time, which takes some tenths of a
// millisecond.
constexpr std::size_t block_bytes = std::size_t{1} << 22;

}  // namespace

void InputFile::read(std::span<std::byte> bytes, std::uint64_t offset) const {
  if (bytes.size() <= block_bytes) return read_block(bytes, offset);
  parallel_for_ranges(std::size_t{0}, bytes.size(), block_bytes, [&](const auto& range) {
    read_block(bytes.subspan(range.begin(), range.size()), offset + range.begin());
  });
}

}  // namespace kerf
