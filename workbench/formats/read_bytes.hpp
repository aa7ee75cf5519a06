// Files into memory.
#pragma once

#include <filesystem>
#include <string>

namespace workbench {

/// The contents of the file, unpacked if its first bytes say that it is gzipped. Throws `kerf::Error` with a
/// line that names the file: `io` if it cannot be read, `bad_format` if it is empty or its compressed data
/// are damaged.
std::string read_bytes(const std::filesystem::path& file);

}  // namespace workbench
