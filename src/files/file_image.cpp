#include "files/file_image.hpp"

namespace kerf {

std::span<const std::byte> zeros(std::uint64_t count) {
  static constexpr std::array<std::byte, FileLayout::alignment> all{};
  return std::span(all).first(static_cast<std::size_t>(count));
}

std::vector<std::byte> joined(std::span<const std::span<const std::byte>> pieces, std::uint64_t bytes) {
  std::vector<std::byte> all;
  all.reserve(static_cast<std::size_t>(bytes));
  for (const auto& piece : pieces) all.insert(all.end(), piece.begin(), piece.end());
  return all;
}

FileImage::FileImage(const Structure& structure)
    : header_(make_header(structure)), annex_(make_annex(structure)) {
  const FileLayout layout(header_);
  static constexpr std::uint32_t no_triangles[] = {0};
  const auto& first = structure.first_triangles;
  const auto padding = [](std::uint64_t from, std::uint64_t to) { return zeros(to - from); };
  pieces_ = {
      std::as_bytes(std::span(&header_, 1)),
      padding(sizeof header_, layout.meshes_at),
      std::as_bytes(first.empty() ? std::span<const std::uint32_t>(no_triangles) : std::span(first)),
      padding(layout.meshes_at + layout.meshes_bytes, layout.nodes_at),
      structure.wide.node_memory_view(),
      padding(layout.nodes_at + layout.nodes_bytes, layout.leaves_at),
      std::as_bytes(structure.wide.leaves),
      padding(layout.leaves_at + layout.leaves_bytes, layout.annex_at),
      std::as_bytes(std::span(&annex_, layout.annex_bytes != 0 ? 1 : 0)),
      padding(layout.annex_at + layout.annex_bytes, layout.masks_at),
      std::as_bytes(std::span(structure.masks)),
      padding(layout.masks_at + layout.masks_bytes, layout.file_bytes),
  };
}

}  // namespace kerf
