// Bytes that come one after another, and are then looked at as one row.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <utility>

namespace workbench {

/// A part of the address space: the process's own memory, or what a file holds.
class Mapping {
 public:
  Mapping() = default;
  /// `size` bytes of a file that is open; not empty. Throws `kerf::Error` about `file`.
  static Mapping of_file(const std::filesystem::path& file, int descriptor, std::size_t size);
  ~Mapping();
  Mapping(Mapping&& other) noexcept { swap(other); }
  Mapping& operator=(Mapping&& other) noexcept {
    swap(other);
    return *this;
  }

  std::string_view view() const { return {data_, size_}; }

  /// Says that `part` of the view will hardly be read again, so that a large file need not stay in memory.
  void release(std::string_view part) const;

  /// Appends to the process's own memory.
  void append(const std::filesystem::path& file, std::string_view bytes);

 private:
  void swap(Mapping& other) noexcept;

  char* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t reserved_ = 0;  ///< bytes of address space from `data_` on
  bool is_of_file_ = false;
};

/// Where large temporary files belong: $TMPDIR, or else /var/tmp, since /tmp is memory on many systems.
std::filesystem::path folder_of_large_files();

/// Collects what a pipe gives or what a file unpacks to. A few hundred megabytes stay in memory; more goes to
/// a temporary file without a name, from which the system takes into memory what is being read.
class CollectedBytes {
 public:
  static constexpr std::size_t max_in_memory = std::size_t{1} << 28;

  /// `file` is what errors are about.
  explicit CollectedBytes(std::filesystem::path file, std::size_t in_memory = max_in_memory,
                          std::filesystem::path folder = folder_of_large_files())
      : file_(std::move(file)), in_memory_(in_memory), folder_(std::move(folder)) {}
  ~CollectedBytes();
  CollectedBytes(const CollectedBytes&) = delete;
  CollectedBytes& operator=(const CollectedBytes&) = delete;

  std::size_t size() const { return size_; }

  /// Throws `kerf::Error`: `out_of_memory`, or `io` where the temporary file cannot be made or written.
  void append(std::string_view bytes);

  /// All that was appended.
  Mapping take();

 private:
  void begin_file();
  void write(std::string_view bytes);
  [[noreturn]] void raise_no_file() const;

  const std::filesystem::path file_;
  const std::size_t in_memory_;
  const std::filesystem::path folder_;
  std::size_t size_ = 0;
  Mapping memory_;
  int descriptor_ = -1;  ///< of the temporary file
};

}  // namespace workbench
