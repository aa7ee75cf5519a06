// Files as the system gives them: opened, read, mapped, and replaced whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

namespace kerf {

/// A regular file, open for reading. All throw `Error::io`, whose sentence names the file.
class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::uint64_t size() const { return size_; }

  /// Fills `bytes` with those at `offset`; on all cores if they are many.
  void read(std::span<std::byte> bytes, std::uint64_t offset) const;

  /// The whole file, mapped; its memory follows what others write to the file. Not for an empty file.
  std::shared_ptr<const std::byte> map() const;

 private:
  void read_part(std::span<std::byte> bytes, std::uint64_t offset) const;

  const std::filesystem::path& path_;
  int descriptor_;
  std::uint64_t size_;
};

/// Writes `parts` one after another to a new file beside `path`, waits until they are on the disk, and gives
/// it the name `path`: whenever the machine or the process stops, `path` is the old file or the new one. If
/// the process stops in between, the new file may be left behind under its temporary name, `path` with a
/// number and ".tmp" behind it. A symbolic link stays, and the file it names is replaced; what is there and
/// not a file, such as a device, is left alone. Throws `Error::io`, having removed the temporary file.
void replace_file(const std::filesystem::path& path, std::span<const std::span<const std::byte>> parts);

}  // namespace kerf
