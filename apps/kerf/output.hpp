// Results go to files or to standard output. All functions throw `kerf::Error::io` with a line that names the
// file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kerf_tool {

/// The name that stands for standard output.
inline constexpr const char* standard_output = "-";

/// Checks, before long work begins, that `file` can be written. Leaves everything as it is.
void require_writable(const std::string& file);

/// The same for a file in `directory`, which need not exist.
void require_writable_directory(const std::string& directory);

/// Writes all of `bytes` to `file`, or to standard output. A file is there as a whole or as it was before:
/// it is written beside its place and then renamed. Devices and pipes are written as they are.
void write_output(const std::string& file, std::string_view bytes);

/// The same for a file in `directory`, which is made if it does not exist, and is gone again if the file
/// cannot be written.
void write_in_directory(const std::string& directory, const std::string& name, std::string_view bytes);

}  // namespace kerf_tool
