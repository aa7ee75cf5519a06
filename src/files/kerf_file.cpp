#include <algorithm>
#include <array>
#include <cstdio>

#include <kerf/error.hpp>

#include "base/aligned_array.hpp"
#include "base/out_of_memory.hpp"
#include "files/file_image.hpp"
#include "files/posix_file.hpp"

namespace kerf {
namespace {

// Calls `work`; what it throws says which file it speaks of.
template <class Work>
decltype(auto) naming(const std::filesystem::path& path, Work&& work) {
  try {
    return report_out_of_memory(std::forward<Work>(work));
  } catch (const Error& error) {
    if (error.code() == Error::io) throw;  // these name the file themselves
    char sentence[512];
    std::snprintf(sentence, sizeof sentence, "%s: %s", path.c_str(), error.what());
    throw Error(error.code(), sentence);
  }
}

// Reads the header alone first: its sizes must be those of the file before memory is taken for the rest.
void check_header(const InputFile& file) {
  std::array<std::byte, sizeof(FileHeader)> bytes;
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), bytes.size()));
  file.read(std::span(bytes).first(count), 0);
  read_header(std::span(bytes).first(count), file.size());
}

}  // namespace

void Bvh::save(const std::filesystem::path& path) const {
  naming(path, [&] {
    const FileHeader header = make_header(*structure_);
    const FileLayout layout(header);
    static constexpr std::array<std::byte, FileLayout::alignment> zeros{};
    static constexpr std::uint32_t no_triangles[] = {0};
    const auto& first = structure_->first_triangles;
    const auto padding = [&](std::uint64_t from, std::uint64_t to) {
      return std::span(zeros).first(static_cast<std::size_t>(to - from));
    };
    const std::span<const std::byte> parts[] = {
        std::as_bytes(std::span(&header, 1)),
        padding(sizeof header, layout.meshes_at),
        std::as_bytes(first.empty() ? std::span<const std::uint32_t>(no_triangles) : std::span(first)),
        padding(layout.meshes_at + layout.meshes_bytes, layout.nodes_at),
        std::as_bytes(structure_->wide.nodes),
        padding(layout.nodes_at + layout.nodes_bytes, layout.leaves_at),
        std::as_bytes(structure_->wide.leaves),
        padding(layout.leaves_at + layout.leaves_bytes, layout.file_bytes),
    };
    replace_file(path, parts);
  });
}

Bvh Bvh::load(const std::filesystem::path& path) {
  return naming(path, [&] {
    const InputFile file(path);
    check_header(file);
    const AlignedArray<std::byte> image(static_cast<std::size_t>(file.size()));
    file.read({image.data(), image.size()}, 0);
    return Bvh(read_image({image.data(), image.size()}, image.owner()));
  });
}

Bvh Bvh::map(const std::filesystem::path& path) {
  return naming(path, [&] {
    const InputFile file(path);
    check_header(file);
    std::shared_ptr<const std::byte> memory = file.map();
    const std::span image(memory.get(), static_cast<std::size_t>(file.size()));
    return Bvh(read_image(image, std::move(memory)));
  });
}

}  // namespace kerf
