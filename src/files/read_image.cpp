#include "files/read_image.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "files/check_structure.hpp"
#include "files/checksum.hpp"
#include "files/file_header.hpp"
#include "layout/change_width.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

bool all_zero(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

struct Checksums {
  std::uint64_t meshes, nodes, leaves;
};

// Leaves take most of a file, so that one thread sums them and another sums the rest.
Checksums checksums(std::span<const std::byte> meshes, std::span<const std::byte> nodes,
                    std::span<const std::byte> leaves) {
  Checksums sums;
  const auto meshes_and_nodes = [&] {
    sums.meshes = checksum(meshes);
    sums.nodes = checksum(nodes);
  };
  const auto leaves_alone = [&] { sums.leaves = checksum(leaves); };
  constexpr std::size_t min_bytes_for_two_threads = std::size_t{1} << 20;
  if (leaves.size() < min_bytes_for_two_threads) {
    meshes_and_nodes();
    leaves_alone();
  } else {
    parallel_invoke(meshes_and_nodes, leaves_alone);
  }
  return sums;
}

}  // namespace

std::shared_ptr<Structure> read_image(std::span<const std::byte> image, std::shared_ptr<const void> owner,
                                      OtherWidth other_width) {
  const FileHeader header = read_header(image, image.size());
  const FileLayout layout(header);
  const auto meshes = image.subspan(layout.meshes_at, layout.meshes_bytes);
  const auto nodes = image.subspan(layout.nodes_at, layout.nodes_bytes);
  const auto leaves = image.subspan(layout.leaves_at, layout.leaves_bytes);
  const Checksums found = checksums(meshes, nodes, leaves);
  if (found.meshes != header.meshes_checksum)
    raise(Error::bad_format, "the list of meshes is damaged: wrong checksum");
  if (found.nodes != header.nodes_checksum) raise(Error::bad_format, "the nodes are damaged: wrong checksum");
  if (found.leaves != header.leaves_checksum)
    raise(Error::bad_format, "the triangles are damaged: wrong checksum");
  const auto gap = [&](std::uint64_t from, std::uint64_t to) { return image.subspan(from, to - from); };
  if (!all_zero(gap(sizeof(FileHeader), layout.meshes_at)) ||
      !all_zero(gap(layout.meshes_at + layout.meshes_bytes, layout.nodes_at)) ||
      !all_zero(gap(layout.nodes_at + layout.nodes_bytes, layout.leaves_at)) ||
      !all_zero(gap(layout.leaves_at + layout.leaves_bytes, layout.annex_at)) ||
      !all_zero(gap(layout.annex_at + layout.annex_bytes, layout.masks_at)) ||
      !all_zero(gap(layout.masks_at + layout.masks_bytes, layout.file_bytes))) {
    raise(Error::bad_format, "the file is damaged between its sections");
  }

  std::vector<std::uint32_t> first_triangles(meshes.size() / sizeof(std::uint32_t));
  std::memcpy(first_triangles.data(), meshes.data(), meshes.size());
  WideBvh wide;
  wide.width = header.node_width;
  wide.node_count = header.nodes;
  wide.node_data = nodes.data();
  wide.leaves = {reinterpret_cast<const std::uint32_t*>(leaves.data()),
                 static_cast<std::size_t>(header.leaf_words)};
  wide.bounds = header.bounds;
  if (!wide.empty()) wide.largest_coordinate = largest_coordinate(wide.bounds);
  wide.depth = header.depth;
  wide.node_memory = owner;
  wide.leaf_memory = std::move(owner);
  check_structure(wide, first_triangles, header);
  const std::uint32_t width = choose_kernels().node_width;
  if (!wide.empty() && wide.width != width) {
    if (other_width == OtherWidth::refuse) {
      raise(Error::bad_format,
            "the file has nodes of %u children, but this machine traces nodes of %u: load the file instead, "
            "or map one that was written on such a machine",
            wide.width, width);
    }
    wide = isolated([&] { return change_width(wide, first_triangles.back(), width); });
  }
  const FileAnnex annex = read_annex(image.subspan(layout.annex_at, layout.annex_bytes), header);
  const auto masks = image.subspan(layout.masks_at, layout.masks_bytes);
  if (annex.masks_checksum != (masks.empty() ? 0 : checksum(masks)))
    raise(Error::bad_format, "the masks are damaged: wrong checksum");
  auto structure = make_structure(std::move(wide), std::move(first_triangles),
                                  static_cast<std::size_t>(header.degenerate_triangles));
  structure->origin = annex.origin;
  if (!masks.empty()) {
    structure->masks.resize(masks.size() / sizeof(std::uint32_t));
    std::memcpy(structure->masks.data(), masks.data(), masks.size());
  }
  structure->statistics.non_finite_triangles = static_cast<std::size_t>(annex.non_finite_triangles);
  structure->statistics.degenerate_by_rounding = static_cast<std::size_t>(annex.degenerate_by_rounding);
  return structure;
}

}  // namespace kerf
