#include "output.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <system_error>

#include "workbench/base/raise.hpp"

namespace kerf_tool {
namespace {

using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

[[noreturn]] void raise_io(std::string_view file, std::string_view what, int error) {
  workbench::raise(kerf::Error::io, file, "{}: {}", what, std::generic_category().message(error));
}

Stream open(const std::string& file, const char* mode) {
  Stream stream(std::fopen(file.c_str(), mode), &std::fclose);
  if (!stream) raise_io(file, "cannot be written", errno);
  return stream;
}

void write(std::FILE* stream, std::string_view name, std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream) != bytes.size() || std::fflush(stream) != 0) {
    raise_io(name, "cannot be written", errno);
  }
}

}  // namespace

void require_writable(const std::string& file) {
  if (file.empty() || file == standard_output) return;
  std::error_code ignored;
  const bool was_there = std::filesystem::exists(file, ignored);
  open(file, "ab");
  if (!was_there) std::filesystem::remove(file, ignored);
}

void require_writable_directory(const std::string& directory) {
  if (directory.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) raise_io(directory, "the directory cannot be made", error.value());
  require_writable((std::filesystem::path(directory) / "index.html").string());
}

void write_output(const std::string& file, std::string_view bytes) {
  if (file == standard_output) return write(stdout, "standard output", bytes);
  const Stream stream = open(file, "wb");
  write(stream.get(), file, bytes);
}

}  // namespace kerf_tool
