// Paths as sentences show them, and where they lead.
#pragma once

#include <filesystem>
#include <string>

#include <kerf/file_name.hpp>

namespace kerf {

/// The bytes that the system has, which takes no memory; on Windows, in UTF-8.
#ifdef _WIN32
std::string text_of(const std::filesystem::path& path);
#else
inline const std::string& text_of(const std::filesystem::path& path) {
  return path.native();
}
#endif

/// The path of that name. Throws `std::bad_alloc`.
std::filesystem::path path_of(const FileName& name);

/// To the system a path ends at a zero character: it would open another file. Throws `Error::io` for one.
void check_path(const std::filesystem::path& path);

/// The file that `path` stands for: the end of a chain of symbolic links, whether it exists or not. Throws
/// `Error::io`.
std::filesystem::path follow_links(std::filesystem::path path);

/// The name of a new file beside `final_path`; another one at each call.
std::filesystem::path temporary_name(const std::filesystem::path& final_path);

}  // namespace kerf
