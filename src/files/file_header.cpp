#include "files/file_header.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/raise.hpp"
#include "files/checksum.hpp"
#include "structure.hpp"

namespace kerf {
namespace {

std::uint64_t aligned(std::uint64_t offset) {
  return (offset + FileLayout::alignment - 1) / FileLayout::alignment * FileLayout::alignment;
}

std::span<const std::byte> before_checksum(const FileHeader& header) {
  return std::as_bytes(std::span(&header, 1)).first(offsetof(FileHeader, header_checksum));
}
std::span<const std::byte> before_checksum(const FileAnnex& annex) {
  return std::as_bytes(std::span(&annex, 1)).first(offsetof(FileAnnex, checksum));
}

}  // namespace

FileLayout::FileLayout(const FileHeader& header)
    : meshes_at(aligned(sizeof(FileHeader))),
      meshes_bytes((std::uint64_t{header.meshes} + 1) * sizeof(std::uint32_t)),
      nodes_at(aligned(meshes_at + meshes_bytes)),
      nodes_bytes(std::uint64_t{header.nodes} * header.node_width * 32),
      leaves_at(aligned(nodes_at + nodes_bytes)),
      leaves_bytes(header.leaf_words * sizeof(std::uint32_t)),
      annex_at(aligned(leaves_at + leaves_bytes)),
      annex_bytes(header.file_bytes > annex_at ? sizeof(FileAnnex) : 0),
      masks_at(aligned(annex_at + annex_bytes)),
      masks_bytes(header.file_bytes > annex_at + alignment
                      ? std::uint64_t{header.meshes} * sizeof(std::uint32_t)
                      : 0),
      file_bytes(aligned(masks_at + masks_bytes)) {}

FileHeader make_header(const Structure& structure) {
  const WideBvh& wide = structure.wide;
  FileHeader header;
  header.triangles = structure.statistics.triangles;
  header.degenerate_triangles = structure.statistics.degenerate_triangles;
  const std::size_t ends =
      structure.first_triangles.size();  // one more than meshes, or none in an empty handle
  header.meshes = static_cast<std::uint32_t>(ends == 0 ? 0 : ends - 1);
  header.nodes = wide.node_count;
  header.node_width = wide.width;
  header.leaf_words = wide.leaves.size();
  header.depth = wide.depth;
  header.bounds = wide.bounds;
  static constexpr std::uint32_t no_triangles[] = {0};
  header.meshes_checksum = checksum(std::as_bytes(ends == 0 ? std::span<const std::uint32_t>(no_triangles)
                                                            : std::span(structure.first_triangles)));
  header.nodes_checksum = checksum(wide.node_memory_view());
  header.leaves_checksum = checksum(std::as_bytes(wide.leaves));
  header.file_bytes = FileLayout(header).annex_at;
  if (!make_annex(structure).empty()) {
    header.file_bytes += FileLayout::alignment + aligned(std::as_bytes(std::span(structure.masks)).size());
  }
  header.header_checksum = checksum(before_checksum(header));
  return header;
}

FileAnnex make_annex(const Structure& structure) {
  FileAnnex annex{.origin = structure.origin,
                  .non_finite_triangles = structure.statistics.non_finite_triangles,
                  .degenerate_by_rounding = structure.statistics.degenerate_by_rounding};
  if (!structure.masks.empty()) annex.masks_checksum = checksum(std::as_bytes(std::span(structure.masks)));
  annex.checksum = checksum(before_checksum(annex));
  return annex;
}

FileAnnex read_annex(std::span<const std::byte> bytes, const FileHeader& header) {
  FileAnnex annex;
  if (bytes.empty()) return annex;
  std::memcpy(&annex, bytes.data(), sizeof annex);
  if (annex.checksum != checksum(before_checksum(annex)))
    raise(Error::bad_format, "the annex is damaged: wrong checksum");
  const Vec3d& o = annex.origin;
  if (!std::isfinite(o.x) || !std::isfinite(o.y) || !std::isfinite(o.z))
    raise(Error::bad_format, "the origin is (%g, %g, %g)", o.x, o.y, o.z);
  if (annex.empty() || annex.degenerate_by_rounding > header.degenerate_triangles ||
      annex.non_finite_triangles > header.triangles - header.degenerate_triangles) {
    raise(Error::bad_format, "the annex names impossible numbers of triangles");
  }
  return annex;
}

FileHeader read_header(std::span<const std::byte> bytes, std::uint64_t file_bytes) {
  FileHeader header;
  if (file_bytes == 0) raise(Error::bad_format, "the file is empty");
  const std::size_t magic_bytes = std::min(bytes.size(), sizeof header.magic);
  if (std::memcmp(bytes.data(), FileHeader::expected_magic.data(), magic_bytes) != 0) {
    raise(Error::bad_format, "this is not a .kerf file");
  }
  if (bytes.size() < sizeof header) raise(Error::bad_format, "the file is truncated within its header");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.byte_order == std::uint32_t{0x04030201}) {
    raise(Error::bad_format, "the file was written on a machine with the other byte order");
  }
  if (header.byte_order != FileHeader::native_byte_order)
    raise(Error::bad_format, "the byte order mark is damaged");
  if (header.version == FileHeader::version_of_scenes)
    raise(Error::bad_format, "the file holds a scene of instances, not one hierarchy: load it as a scene");
  if (header.version < FileHeader::oldest_version || header.version > FileHeader::current_version) {
    raise(Error::bad_format, "the file has format version %u, but this kerf reads versions %u to %u",
          header.version, FileHeader::oldest_version, FileHeader::current_version);
  }
  if (header.header_checksum != checksum(before_checksum(header)))
    raise(Error::bad_format, "the header is damaged: wrong checksum");
  // From here on a wrong value was put there on purpose.
  constexpr std::uint64_t max_words =
      words_per_triangle * std::uint64_t{ChildLink::max_place} + leaf_padding_words;
  if (header.leaf_words > max_words || header.nodes > ChildLink::max_place)
    raise(Error::bad_format, "the header names impossible sizes");
  if (header.version == FileHeader::oldest_version) {
    if (header.node_width != 0) raise(Error::bad_format, "the header has something where a zero belongs");
    header.node_width = 16;
  }
  if (header.node_width != 16 && header.node_width != 8 && header.node_width != 4)
    raise(Error::bad_format, "the header names nodes of %u children, but there are 16, 8 or 4",
          header.node_width);
  if (header.file_bytes != FileLayout(header).file_bytes)
    raise(Error::bad_format, "the sizes in the header do not add up");
  if (header.file_bytes != file_bytes) {
    raise(Error::bad_format, "the file has %llu bytes, but should have %llu",
          static_cast<unsigned long long>(file_bytes), static_cast<unsigned long long>(header.file_bytes));
  }
  return header;
}

}  // namespace kerf
