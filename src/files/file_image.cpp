#include "files/file_image.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <limits>

#include <kerf/error.hpp>

#include "base/parallel.hpp"
#include "files/checksum.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

[[noreturn]] void refuse(const char* sentence) {
  throw Error(Error::bad_format, sentence);
}

template <class... Values>
[[noreturn]] void refuse(const char* format, Values... values) {
  char sentence[256];
  std::snprintf(sentence, sizeof sentence, format, values...);
  throw Error(Error::bad_format, sentence);
}

std::span<const std::byte> before_checksum(const FileHeader& header) {
  return std::as_bytes(std::span(&header, 1)).first(offsetof(FileHeader, header_checksum));
}

bool all_zero(std::span<const std::byte> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

struct Checksums {
  std::uint64_t meshes, nodes, leaves;
};

// Leaves are most of a file: who has them has half of the work.
Checksums checksums(std::span<const std::byte> meshes, std::span<const std::byte> nodes,
                    std::span<const std::byte> leaves) {
  Checksums sums;
  const auto meshes_and_nodes = [&] {
    sums.meshes = checksum(meshes);
    sums.nodes = checksum(nodes);
  };
  const auto only_leaves = [&] { sums.leaves = checksum(leaves); };
  constexpr std::size_t worth_two_threads = std::size_t{1} << 20;
  if (leaves.size() < worth_two_threads) {
    meshes_and_nodes();
    only_leaves();
  } else {
    parallel_invoke(meshes_and_nodes, only_leaves);
  }
  return sums;
}

}  // namespace

FileHeader make_header(const Bvh::Structure& structure) {
  const WideBvh& wide = structure.wide;
  FileHeader header;
  header.triangles = structure.statistics.triangles;
  header.degenerate_triangles = structure.statistics.degenerate_triangles;
  const std::size_t ends =
      structure.first_triangles.size();  // one more than meshes, or none in an empty handle
  header.meshes = static_cast<std::uint32_t>(ends == 0 ? 0 : ends - 1);
  header.nodes = static_cast<std::uint32_t>(wide.nodes.size());
  header.leaf_words = wide.leaves.size();
  header.depth = wide.depth;
  header.bounds = wide.bounds;
  static constexpr std::uint32_t no_triangles[] = {0};
  header.meshes_checksum = checksum(std::as_bytes(ends == 0 ? std::span<const std::uint32_t>(no_triangles)
                                                            : std::span(structure.first_triangles)));
  header.nodes_checksum = checksum(std::as_bytes(wide.nodes));
  header.leaves_checksum = checksum(std::as_bytes(wide.leaves));
  header.file_bytes = FileLayout(header).file_bytes;
  header.header_checksum = checksum(before_checksum(header));
  return header;
}

FileHeader read_header(std::span<const std::byte> bytes, std::uint64_t file_bytes) {
  FileHeader header;
  if (file_bytes == 0) refuse("the file is empty");
  const std::size_t magic_bytes = std::min(bytes.size(), sizeof header.magic);
  if (std::memcmp(bytes.data(), FileHeader::expected_magic.data(), magic_bytes) != 0) {
    refuse("this is not a .kerf file");
  }
  if (bytes.size() < sizeof header) refuse("the file is truncated within its header");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.byte_order == std::uint32_t{0x04030201}) {
    refuse("the file was written on a machine with the other byte order");
  }
  if (header.byte_order != FileHeader::native_byte_order) refuse("the byte order mark is damaged");
  if (header.version != FileHeader::current_version) {
    refuse("the file has format version %u, but this kerf reads version %u", header.version,
           FileHeader::current_version);
  }
  if (header.header_checksum != checksum(before_checksum(header)))
    refuse("the header is damaged: wrong checksum");
  // From here on a wrong value was put there on purpose.
  constexpr std::uint64_t most_words =
      words_per_triangle * std::uint64_t{ChildLink::max_place} + leaf_padding_words;
  if (header.leaf_words > most_words || header.nodes > ChildLink::max_place)
    refuse("the header names impossible sizes");
  if (header.zero != 0) refuse("the header has something where a zero belongs");
  if (header.file_bytes != FileLayout(header).file_bytes) refuse("the sizes in the header do not add up");
  if (header.file_bytes != file_bytes) {
    refuse("the file has %llu bytes, but should have %llu", static_cast<unsigned long long>(file_bytes),
           static_cast<unsigned long long>(header.file_bytes));
  }
  return header;
}

std::shared_ptr<Bvh::Structure> read_image(std::span<const std::byte> image,
                                           std::shared_ptr<const void> memory) {
  const FileHeader header = read_header(image, image.size());
  const FileLayout layout(header);
  const auto meshes = image.subspan(layout.meshes_at, layout.meshes_bytes);
  const auto nodes = image.subspan(layout.nodes_at, layout.nodes_bytes);
  const auto leaves = image.subspan(layout.leaves_at, layout.leaves_bytes);
  const Checksums found = checksums(meshes, nodes, leaves);
  if (found.meshes != header.meshes_checksum) refuse("the list of meshes is damaged: wrong checksum");
  if (found.nodes != header.nodes_checksum) refuse("the nodes are damaged: wrong checksum");
  if (found.leaves != header.leaves_checksum) refuse("the triangles are damaged: wrong checksum");
  const auto gap = [&](std::uint64_t from, std::uint64_t to) { return image.subspan(from, to - from); };
  if (!all_zero(gap(sizeof(FileHeader), layout.meshes_at)) ||
      !all_zero(gap(layout.meshes_at + layout.meshes_bytes, layout.nodes_at)) ||
      !all_zero(gap(layout.nodes_at + layout.nodes_bytes, layout.leaves_at)) ||
      !all_zero(gap(layout.leaves_at + layout.leaves_bytes, layout.file_bytes))) {
    refuse("the file is damaged between its sections");
  }

  auto structure = std::make_shared<Bvh::Structure>();
  structure->first_triangles.resize(meshes.size() / sizeof(std::uint32_t));
  std::memcpy(structure->first_triangles.data(), meshes.data(), meshes.size());
  WideBvh& wide = structure->wide;
  wide.nodes = {reinterpret_cast<const WideNode*>(nodes.data()), header.nodes};
  wide.leaves = {reinterpret_cast<const std::uint32_t*>(leaves.data()),
                 static_cast<std::size_t>(header.leaf_words)};
  wide.bounds = header.bounds;
  if (!wide.empty()) wide.largest_coordinate = largest_coordinate(wide.bounds);
  wide.depth = header.depth;
  wide.node_memory = memory;
  wide.leaf_memory = std::move(memory);
  BvhStatistics& statistics = structure->statistics;
  statistics.triangles = header.triangles;
  statistics.degenerate_triangles = header.degenerate_triangles;
  check_structure(*structure);
  statistics.references = wide.references();
  statistics.nodes = wide.nodes.size();
  statistics.bytes = wide.nodes.size_bytes() + wide.leaves.size_bytes();
  structure->kernels = &choose_kernels();
  return structure;
}

}  // namespace kerf
