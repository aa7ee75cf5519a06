#include "files/scene_header.hpp"

#include <algorithm>
#include <cstring>

#include "base/raise.hpp"
#include "files/checksum.hpp"

namespace kerf {
namespace {

constexpr std::uint32_t max_count = FileInstance::scene_bit;

std::span<const std::byte> before_checksum(const SceneFileHeader& header) {
  return std::as_bytes(std::span(&header, 1)).first(offsetof(SceneFileHeader, header_checksum));
}

template <class T>
void take(std::span<const std::byte>& bytes, std::vector<T>& values, std::uint64_t count) {
  values.resize(static_cast<std::size_t>(count));
  const std::size_t size = values.size() * sizeof(T);
  if (size != 0) std::memcpy(values.data(), bytes.data(), size);
  bytes = bytes.subspan(size);
}

}  // namespace

SceneLayout::SceneLayout(const SceneFileHeader& header)
    : tables_bytes((std::uint64_t{header.objects} + header.scenes) * sizeof(std::uint64_t) +
                   header.instances * sizeof(FileInstance)),
      objects_at((tables_at + tables_bytes + FileLayout::alignment - 1) / FileLayout::alignment *
                 FileLayout::alignment) {}

SceneFileHeader make_header(const SceneTables& tables) {
  SceneFileHeader header;
  if (tables.object_bytes.size() >= max_count || tables.instance_counts.size() >= max_count)
    raise(Error::too_large, "a file cannot hold 2^31 hierarchies or scenes");
  header.objects = static_cast<std::uint32_t>(tables.object_bytes.size());
  header.scenes = static_cast<std::uint32_t>(tables.instance_counts.size());
  header.instances = tables.instances.size();
  header.file_bytes = SceneLayout(header).objects_at;
  for (const std::uint64_t bytes : tables.object_bytes) header.file_bytes += bytes;
  std::vector<std::byte> all;
  for (const auto& piece : tables.pieces()) all.insert(all.end(), piece.begin(), piece.end());
  header.tables_checksum = checksum(all);
  header.header_checksum = checksum(before_checksum(header));
  return header;
}

bool holds_scene(std::span<const std::byte> bytes) {
  SceneFileHeader header;
  if (bytes.size() < offsetof(SceneFileHeader, file_bytes)) return false;
  std::memcpy(static_cast<void*>(&header), bytes.data(), offsetof(SceneFileHeader, file_bytes));
  return header.magic == FileHeader::expected_magic && header.byte_order == FileHeader::native_byte_order &&
         header.version == FileHeader::version_of_scenes;
}

SceneFileHeader read_scene_header(std::span<const std::byte> bytes, std::uint64_t file_bytes) {
  SceneFileHeader header;
  if (bytes.size() < sizeof header) raise(Error::bad_format, "the file is truncated within its header");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.header_checksum != checksum(before_checksum(header)))
    raise(Error::bad_format, "the header is damaged: wrong checksum");
  if (header.kind != SceneFileHeader::kind_of_scenes)
    raise(Error::bad_format, "the file holds something that this kerf does not know (kind %u)", header.kind);
  if (header.zero != 0) raise(Error::bad_format, "the header has something where a zero belongs");
  if (header.scenes == 0 || header.scenes >= max_count || header.objects >= max_count ||
      header.instances > file_bytes / sizeof(FileInstance) ||
      header.file_bytes < SceneLayout(header).objects_at)
    raise(Error::bad_format, "the header names impossible sizes");
  if (header.file_bytes != file_bytes) {
    raise(Error::bad_format, "the file has %llu bytes, but should have %llu",
          static_cast<unsigned long long>(file_bytes), static_cast<unsigned long long>(header.file_bytes));
  }
  return header;
}

SceneTables read_tables(std::span<const std::byte> image, const SceneFileHeader& header) {
  const SceneLayout layout(header);
  std::span<const std::byte> bytes =
      image.subspan(layout.tables_at, static_cast<std::size_t>(layout.tables_bytes));
  if (checksum(bytes) != header.tables_checksum)
    raise(Error::bad_format, "the list of instances is damaged: wrong checksum");
  const auto gap = image.first(static_cast<std::size_t>(layout.objects_at))
                       .subspan(static_cast<std::size_t>(layout.tables_at + layout.tables_bytes));
  if (!std::all_of(gap.begin(), gap.end(), [](std::byte b) { return b == std::byte{0}; }))
    raise(Error::bad_format, "the file is damaged between its sections");

  SceneTables tables;
  take(bytes, tables.object_bytes, header.objects);
  take(bytes, tables.instance_counts, header.scenes);
  take(bytes, tables.instances, header.instances);
  std::uint64_t left = header.file_bytes - layout.objects_at;
  for (std::size_t i = 0; i < tables.object_bytes.size(); ++i) {
    const std::uint64_t size = tables.object_bytes[i];
    if (size % FileLayout::alignment != 0 || size > left)
      raise(Error::bad_format, "hierarchy %zu has an impossible length", i);
    left -= size;
  }
  if (left != 0) raise(Error::bad_format, "the lengths of the hierarchies do not add up");
  std::size_t first = 0;
  for (std::uint32_t scene = 0; scene < header.scenes; ++scene) {
    if (tables.instance_counts[scene] > tables.instances.size() - first)
      raise(Error::bad_format, "scene %u has more instances than there are", scene);
    const auto end = first + static_cast<std::size_t>(tables.instance_counts[scene]);
    for (; first < end; ++first) {
      const FileInstance& instance = tables.instances[first];
      const bool is_scene = (instance.what & FileInstance::scene_bit) != 0;
      if (is_scene ? (instance.what & ~FileInstance::scene_bit) >= scene : instance.what >= header.objects)
        raise(Error::bad_format, "an instance of what the file does not hold before it (%zu)", first);
      if (instance.zero != 0)
        raise(Error::bad_format, "an instance with something where a zero belongs (%zu)", first);
    }
  }
  if (first != tables.instances.size()) raise(Error::bad_format, "instances of no scene (%zu)", first);
  return tables;
}

}  // namespace kerf
