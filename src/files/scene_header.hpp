// What stands before the hierarchies in the .kerf file of a scene. The layout is described in
// docs/file-format.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "files/file_header.hpp"

namespace kerf {

struct SceneFileHeader {
  static constexpr std::uint32_t kind_of_scenes = 1;

  std::array<unsigned char, 8> magic = FileHeader::expected_magic;
  std::uint32_t byte_order = FileHeader::native_byte_order;
  std::uint32_t version = FileHeader::version_of_scenes;
  std::uint64_t file_bytes = 0;
  std::uint32_t kind = kind_of_scenes;
  std::uint32_t objects = 0;    ///< hierarchies, each of which is in the file once
  std::uint32_t scenes = 0;     ///< at least one, the outermost, which is the last
  std::uint32_t zero = 0;       ///< for what comes
  std::uint64_t instances = 0;  ///< of all scenes, those of each scene counted once
  std::uint64_t tables_checksum = 0;
  std::uint64_t header_checksum = 0;  ///< of all bytes before it
};
static_assert(sizeof(SceneFileHeader) == 64 && std::is_trivially_copyable_v<SceneFileHeader>);

/// An instance as a file has it.
struct FileInstance {
  static constexpr std::uint32_t scene_bit = 0x80000000u;

  double transform[3][4];
  std::uint32_t what;  ///< number of the object, or of the scene and `scene_bit`
  std::uint32_t mask;
  std::uint32_t number;
  std::uint32_t zero;
};
static_assert(sizeof(FileInstance) == 112 && std::is_trivially_copyable_v<FileInstance>);

/// The tables behind the header.
struct SceneTables {
  std::vector<std::uint64_t> object_bytes;     ///< length of each object's own file, a multiple of 64
  std::vector<std::uint64_t> instance_counts;  ///< of each scene
  std::vector<FileInstance> instances;         ///< of the scenes, one after the other

  std::array<std::span<const std::byte>, 3> pieces() const {
    return {std::as_bytes(std::span(object_bytes)), std::as_bytes(std::span(instance_counts)),
            std::as_bytes(std::span(instances))};
  }
};

/// Where the tables and the hierarchies of a file lie. Hierarchies begin at multiples of 64; zeros fill the
/// space behind the tables.
struct SceneLayout {
  std::uint64_t tables_at = sizeof(SceneFileHeader), tables_bytes, objects_at;

  explicit SceneLayout(const SceneFileHeader& header);
};

/// The header of a file with these tables.
SceneFileHeader make_header(const SceneTables& tables);

/// True for the first bytes of a file of a scene, whether or not the rest of the header is right.
bool holds_scene(std::span<const std::byte> bytes);

/// As `read_header` for hierarchies: `bytes` are the first of the file, at least `sizeof(SceneFileHeader)`
/// unless the file is shorter. Throws `Error::bad_format`.
SceneFileHeader read_scene_header(std::span<const std::byte> bytes, std::uint64_t file_bytes);

/// The tables in `image`, a whole file with that header. Checks all but the hierarchies themselves and what
/// a build refuses. Throws `Error::bad_format`.
SceneTables read_tables(std::span<const std::byte> image, const SceneFileHeader& header);

}  // namespace kerf
