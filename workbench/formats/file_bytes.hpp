// The bytes of a file.
#pragma once

#include <filesystem>
#include <string_view>

#include "workbench/formats/collected_bytes.hpp"

namespace workbench {

/// The contents of a file, mapped where it lies; unpacked if its first bytes say that it is gzipped.
class FileBytes {
 public:
  enum class Packing { none, maybe_gzipped };

  /// Throws `kerf::Error` with a line that names the file: `io` if it cannot be read, `bad_format` if it is
  /// empty or its compressed data are damaged.
  explicit FileBytes(const std::filesystem::path& file, Packing packing = Packing::maybe_gzipped);

  std::string_view view() const { return bytes_.view(); }

  /// Says that `part` of the view will hardly be read again, so that a large file need not stay in memory.
  void release(std::string_view part) const { bytes_.release(part); }

 private:
  Mapping bytes_;
};

}  // namespace workbench
