#include <array>

#include <kerf/bvh.hpp>

#include "files/file_header.hpp"
#include "files/name_file.hpp"
#include "files/system_file.hpp"
#include "structure.hpp"

namespace kerf {

void Bvh::save(const std::filesystem::path& path) const {
  naming_file(path, [&] {
    const FileHeader header = make_header(*structure_);
    const FileAnnex annex = make_annex(*structure_);
    const FileLayout layout(header);
    static constexpr std::array<std::byte, FileLayout::alignment> zeros{};
    static constexpr std::uint32_t no_triangles[] = {0};
    const auto& first = structure_->first_triangles;
    const auto padding = [&](std::uint64_t from, std::uint64_t to) {
      return std::span(zeros).first(static_cast<std::size_t>(to - from));
    };
    const std::span<const std::byte> pieces[] = {
        std::as_bytes(std::span(&header, 1)),
        padding(sizeof header, layout.meshes_at),
        std::as_bytes(first.empty() ? std::span<const std::uint32_t>(no_triangles) : std::span(first)),
        padding(layout.meshes_at + layout.meshes_bytes, layout.nodes_at),
        structure_->wide.node_memory_view(),
        padding(layout.nodes_at + layout.nodes_bytes, layout.leaves_at),
        std::as_bytes(structure_->wide.leaves),
        padding(layout.leaves_at + layout.leaves_bytes, layout.annex_at),
        std::as_bytes(std::span(&annex, layout.annex_bytes != 0 ? 1 : 0)),
        padding(layout.annex_at + layout.annex_bytes, layout.masks_at),
        std::as_bytes(std::span(structure_->masks)),
        padding(layout.masks_at + layout.masks_bytes, layout.file_bytes),
    };
    replace_file(path, pieces);
  });
}

}  // namespace kerf
