#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <kerf/bvh.hpp>

#include "base/out_of_memory.hpp"
#include "files/file_header.hpp"
#include "files/name_file.hpp"
#include "files/system_file.hpp"
#include "structure.hpp"

namespace kerf {

namespace {

// Calls `write` with the pieces that make up a file, which live as long as the call.
template <class Write>
auto with_pieces(const Structure& structure, const Write& write) {
  const FileHeader header = make_header(structure);
  const FileAnnex annex = make_annex(structure);
  const FileLayout layout(header);
  static constexpr std::array<std::byte, FileLayout::alignment> zeros{};
  static constexpr std::uint32_t no_triangles[] = {0};
  const auto& first = structure.first_triangles;
  const auto padding = [&](std::uint64_t from, std::uint64_t to) {
    return std::span(zeros).first(static_cast<std::size_t>(to - from));
  };
  const std::array<std::span<const std::byte>, 12> pieces{
      std::as_bytes(std::span(&header, 1)),
      padding(sizeof header, layout.meshes_at),
      std::as_bytes(first.empty() ? std::span<const std::uint32_t>(no_triangles) : std::span(first)),
      padding(layout.meshes_at + layout.meshes_bytes, layout.nodes_at),
      structure.wide.node_memory_view(),
      padding(layout.nodes_at + layout.nodes_bytes, layout.leaves_at),
      std::as_bytes(structure.wide.leaves),
      padding(layout.leaves_at + layout.leaves_bytes, layout.annex_at),
      std::as_bytes(std::span(&annex, layout.annex_bytes != 0 ? 1 : 0)),
      padding(layout.annex_at + layout.annex_bytes, layout.masks_at),
      std::as_bytes(std::span(structure.masks)),
      padding(layout.masks_at + layout.masks_bytes, layout.file_bytes),
  };
  return write(std::span<const std::span<const std::byte>>(pieces), layout.file_bytes);
}

}  // namespace

void Bvh::save(const std::filesystem::path& path) const {
  naming_file(path, [&] {
    with_pieces(*structure_, [&](std::span<const std::span<const std::byte>> pieces, std::uint64_t) {
      replace_file(path, pieces);
    });
  });
}

std::vector<std::byte> Bvh::save() const {
  return report_out_of_memory([&] {
    return with_pieces(*structure_,
                       [](std::span<const std::span<const std::byte>> pieces, std::uint64_t size) {
                         std::vector<std::byte> bytes;
                         bytes.reserve(static_cast<std::size_t>(size));
                         for (const auto& piece : pieces)
                           bytes.insert(bytes.end(), piece.begin(), piece.end());
                         return bytes;
                       });
  });
}

}  // namespace kerf
