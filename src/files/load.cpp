// Files come back: read into memory, or mapped where they lie.
#include <algorithm>
#include <array>
#include <utility>

#include <kerf/bvh.hpp>

#include "base/aligned_array.hpp"
#include "base/out_of_memory.hpp"
#include "base/parallel.hpp"
#include "files/file_header.hpp"
#include "files/name_file.hpp"
#include "files/read_image.hpp"
#include "files/system_file.hpp"

namespace kerf {
namespace {

// Reads only the header: its sizes must be those of the file before memory is taken for the rest.
void check_header(const InputFile& file) {
  std::array<std::byte, sizeof(FileHeader)> bytes;
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), bytes.size()));
  file.read(std::span(bytes).first(count), 0);
  read_header(std::span(bytes).first(count), file.size());
}

}  // namespace

Bvh Bvh::load(const FileName& name) {
  return naming_file(name, [&](const std::filesystem::path& path) {
    const InputFile file(path);
    check_header(file);
    const AlignedArray<std::byte> image(static_cast<std::size_t>(file.size()));
    file.read({image.data(), image.size()}, 0);
    return Structure::share(read_image({image.data(), image.size()}, image.owner()));
  });
}

Bvh Bvh::load(std::span<const std::byte> bytes) {
  return report_out_of_memory([&] {
    return isolated([&] {
      read_header(bytes.first(std::min(bytes.size(), sizeof(FileHeader))), bytes.size());
      const AlignedArray<std::byte> image(bytes.size());
      std::copy(bytes.begin(), bytes.end(), image.data());
      return Structure::share(read_image({image.data(), image.size()}, image.owner()));
    });
  });
}

Bvh Bvh::map(const FileName& name) {
  return naming_file(name, [&](const std::filesystem::path& path) {
    const InputFile file(path);
    check_header(file);
    std::shared_ptr<const std::byte> memory = file.map();
    const std::span image(memory.get(), static_cast<std::size_t>(file.size()));
    return Structure::share(read_image(image, std::move(memory), OtherWidth::refuse));
  });
}

}  // namespace kerf
