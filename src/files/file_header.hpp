// The first 120 bytes of a .kerf file; docs/file-format.md describes every one of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include <kerf/vec.hpp>

namespace kerf {

struct Structure;

struct FileHeader {
  /// Like that of PNG: a byte that is not text, the name, and line ends that a transfer as text would change.
  static constexpr std::array<unsigned char, 8> expected_magic{0x89, 'k', 'e', 'r', 'f', '\r', '\n', 0x1a};
  static constexpr std::uint32_t native_byte_order = 0x01020304;
  static constexpr std::uint32_t current_version = 3;
  /// Files of this version hold nodes of sixteen children and do not say so. They are still read.
  static constexpr std::uint32_t oldest_version = 2;
  /// Files of this version begin with a `SceneFileHeader`.
  static constexpr std::uint32_t version_of_scenes = 4;

  std::array<unsigned char, 8> magic = expected_magic;
  std::uint32_t byte_order = native_byte_order;
  std::uint32_t version = current_version;
  std::uint64_t file_bytes = 0;
  std::uint64_t triangles = 0;             ///< in the meshes, degenerate ones included
  std::uint64_t degenerate_triangles = 0;  ///< of these, left out of the hierarchy
  std::uint32_t meshes = 0;
  std::uint32_t nodes = 0;
  std::uint64_t leaf_words = 0;
  std::uint32_t depth = 0;
  std::uint32_t node_width = 16;  ///< children of a node: 16, 8 or 4; a zero in version 2
  Box3f bounds;
  std::uint64_t meshes_checksum = 0;
  std::uint64_t nodes_checksum = 0;
  std::uint64_t leaves_checksum = 0;
  std::uint64_t header_checksum = 0;  ///< of all bytes before it
};
static_assert(sizeof(FileHeader) == 120 && std::is_trivially_copyable_v<FileHeader>);

/// What few files have behind the leaves. Files without it are as they were before there was one.
struct FileAnnex {
  Vec3d origin;                              ///< of the local frame
  std::uint64_t non_finite_triangles = 0;    ///< left out of the hierarchy
  std::uint64_t degenerate_by_rounding = 0;  ///< of the degenerate triangles
  std::uint64_t masks_checksum = 0;          ///< 0 where there are no masks
  std::uint64_t checksum = 0;                ///< of all bytes before it

  bool empty() const {
    return origin == Vec3d{} && non_finite_triangles == 0 && degenerate_by_rounding == 0 &&
           masks_checksum == 0;
  }
};
static_assert(sizeof(FileAnnex) == 56 && std::is_trivially_copyable_v<FileAnnex>);

/// Where the sections of a file lie. Each begins at a multiple of 64; zeros fill the space between them.
struct FileLayout {
  static constexpr std::uint64_t alignment = 64;

  std::uint64_t meshes_at, meshes_bytes;
  std::uint64_t nodes_at, nodes_bytes;
  std::uint64_t leaves_at, leaves_bytes;
  std::uint64_t annex_at, annex_bytes;
  std::uint64_t masks_at, masks_bytes;  ///< a mask for each mesh, in few of the files with an annex
  std::uint64_t file_bytes;

  /// `header.leaf_words` must be below 2^60.
  explicit FileLayout(const FileHeader& header);
};

/// The header of the file of `structure`. It depends neither on the machine's speed nor on the number of
/// threads.
FileHeader make_header(const Structure& structure);

/// The annex of the file of `structure`.
FileAnnex make_annex(const Structure& structure);

/// What `bytes`, the annex of a file with this header, say; nothing if there are none. Throws
/// `Error::bad_format`.
FileAnnex read_annex(std::span<const std::byte> bytes, const FileHeader& header);

/// Checks all that a header can tell by itself, and that the file has as many bytes as it says, so that
/// memory can be taken for them. `bytes` are the first of the file, at least `sizeof(FileHeader)` unless the
/// file is shorter. Throws `Error::bad_format`, which says what is wrong.
FileHeader read_header(std::span<const std::byte> bytes, std::uint64_t file_bytes);

}  // namespace kerf
