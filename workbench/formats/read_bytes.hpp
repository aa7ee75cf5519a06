// Files into memory.
#pragma once

#include <filesystem>
#include <string>

namespace workbench {

/// The whole file; if its first bytes say that it is gzipped, what was zipped. Throws `kerf::Error::io` with
/// a line that names the file if it cannot be read, `bad_format` if it is empty or its compressed data are
/// damaged.
std::string read_bytes(const std::filesystem::path& file);

}  // namespace workbench
