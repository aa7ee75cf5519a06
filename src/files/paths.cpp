#include "files/paths.hpp"

#include <cerrno>
#include <random>
#include <system_error>

#include "base/raise.hpp"

namespace kerf {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::error_code& error) {
  raise(Error::io, "%s: cannot be written: %s", text_of(path).c_str(), error.message().c_str());
}

}  // namespace

#ifdef _WIN32
std::string text_of(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  return {reinterpret_cast<const char*>(text.data()), text.size()};
}
#endif

std::filesystem::path path_of(const FileName& name) {
  if (name.wide() != nullptr) return {name.wide(), name.wide() + name.size()};
  return {name.narrow(), name.narrow() + name.size()};
}

void check_path(const std::filesystem::path& path) {
  if (path.native().find(std::filesystem::path::value_type{}) != std::filesystem::path::string_type::npos)
    raise(Error::io, "%s: has a zero byte in its name", text_of(path).c_str());
}

std::filesystem::path follow_links(std::filesystem::path path) {
  constexpr int max_links = 40;  // as many as Linux follows
  std::error_code error;
  for (int links = 0; std::filesystem::is_symlink(path, error); ++links) {
    if (links == max_links) fail(path, std::make_error_code(std::errc::too_many_symbolic_link_levels));
    path = path.parent_path() / std::filesystem::read_symlink(path, error);
    if (error) fail(path, error);
  }
  return path;
}

std::filesystem::path temporary_name(const std::filesystem::path& final_path) {
  // With a number of up to ten digits the name has at most the 255 characters that a system allows.
  constexpr std::size_t max_name = 240;
  std::filesystem::path name = final_path.filename().native().substr(0, max_name);
  name += ".";
  name += std::to_string(std::random_device()());
  name += ".tmp";
  return final_path.parent_path() / name;
}

}  // namespace kerf
