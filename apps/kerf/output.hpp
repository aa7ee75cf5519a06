// Results go to files or to standard output. All functions throw `kerf::Error::io` with a line that names the
// file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kerf_tool {

/// The name that stands for standard output.
inline constexpr const char* standard_output = "-";

/// Checks, before long work begins, that `file` can be written. Leaves it as it is.
void require_writable(const std::string& file);

/// Makes `directory` if it does not exist, and checks that files can be written in it.
void require_writable_directory(const std::string& directory);

/// Writes all of `bytes` to `file`, or to standard output.
void write_output(const std::string& file, std::string_view bytes);

}  // namespace kerf_tool
