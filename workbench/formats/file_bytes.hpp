// The bytes of a file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace workbench {

/// The contents of a file, mapped where it lies; unpacked into memory if its first bytes say that it is
/// gzipped.
class FileBytes {
 public:
  enum class Packing { none, maybe_gzipped };

  /// Throws `kerf::Error` with a line that names the file: `io` if it cannot be read, `bad_format` if it is
  /// empty or its compressed data are damaged.
  explicit FileBytes(const std::filesystem::path& file, Packing packing = Packing::maybe_gzipped);
  ~FileBytes();
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  std::string_view view() const { return {data_, size_}; }

  /// Says that `part` of the view will hardly be read again, so that a large file need not stay in memory.
  void release(std::string_view part) const;

 private:
  void append(const std::filesystem::path& file, const char* bytes, std::size_t count);
  void read_stream(const std::filesystem::path& file, int descriptor);
  void unpack(const std::filesystem::path& file);
  void swap(FileBytes& other) noexcept;
  FileBytes() = default;

  char* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t reserved_ = 0;  ///< bytes of address space from `data_` on
  bool is_mapped_ = false;    ///< from the file; else the process's own memory
};

}  // namespace workbench
