// Files as the system has them: opened, read, mapped, and replaced as a whole. posix_file.cpp and
// windows_file.cpp say how, each for its systems.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace kerf {

/// A regular file, open for reading. All functions throw `Error::io`, whose sentence names the file.
class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::uint64_t size() const { return size_; }

  /// Fills `bytes` with those at `offset`. Many bytes are read on all cores.
  void read(std::span<std::byte> bytes, std::uint64_t offset) const;

  /// The whole file, mapped: its memory changes when others write to the file, and Windows lets nobody
  /// replace it meanwhile. Not for an empty file.
  std::shared_ptr<const std::byte> map() const;

 private:
  void read_block(std::span<std::byte> bytes, std::uint64_t offset) const;

  const std::filesystem::path& path_;
  std::intptr_t handle_;  // what the system calls it
  std::uint64_t size_;
};

/// Writes `pieces` one after another to a new file beside `path`, waits until they are on the disk, and gives
/// the file the name `path`. Whenever the machine or the process stops, `path` is the old file or the new
/// one. If the process stops in between, the new file may be left behind under its temporary name: `path`
/// followed by a number and ".tmp". A symbolic link stays, and the file that it names is replaced. Whatever
/// is not a regular file, such as a device, is left alone. Throws `Error::io`, and removes the temporary file
/// first.
void replace_file(const std::filesystem::path& path, std::span<const std::span<const std::byte>> pieces);

}  // namespace kerf
