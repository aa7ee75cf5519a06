// Files of Windows, by its own calls.
#ifdef _WIN32
#include <algorithm>
#include <string>
#include <system_error>

#include "base/raise.hpp"
#include "files/paths.hpp"
#include "files/system_file.hpp"

#ifndef NOMINMAX
#define NOMINMAX
#endif
#define WIN32_LEAN_AND_MEAN
#include <windows.h>

namespace kerf {
namespace {

// One call moves at most this many bytes: it counts in 32 bits.
constexpr std::size_t max_bytes_per_call = std::size_t{1} << 30;

// For a failed call of the system, whose `GetLastError` was `error`.
[[noreturn]] void fail(const std::filesystem::path& path, const char* what, DWORD error) {
  std::string why = std::system_category().message(static_cast<int>(error));
  while (!why.empty() && (why.back() == '\n' || why.back() == '\r' || why.back() == ' ')) why.pop_back();
  raise(Error::io, "%s: %s: %s", text_of(path).c_str(), what, why.c_str());
}

HANDLE handle_of(std::intptr_t handle) {
  return reinterpret_cast<HANDLE>(handle);
}

// The new file until it has its final name. It is removed if it never gets it.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& final_path) : final_path_(final_path) {
    std::error_code error;
    const std::filesystem::file_status old = std::filesystem::status(final_path, error);
    if (std::filesystem::exists(old) && !std::filesystem::is_regular_file(old))
      raise(Error::io, "%s: is not a file that can be replaced", text_of(final_path).c_str());
    do {
      path_ = temporary_name(final_path);
      handle_ =
          ::CreateFileW(path_.c_str(), GENERIC_WRITE, 0, nullptr, CREATE_NEW, FILE_ATTRIBUTE_NORMAL, nullptr);
    } while (handle_ == INVALID_HANDLE_VALUE && ::GetLastError() == ERROR_FILE_EXISTS);
    if (handle_ == INVALID_HANDLE_VALUE) fail(final_path, "cannot be written", ::GetLastError());
  }
  ~TemporaryFile() {
    if (handle_ != INVALID_HANDLE_VALUE) ::CloseHandle(handle_);
    if (!renamed_) ::DeleteFileW(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const auto size = static_cast<DWORD>(std::min(bytes.size(), max_bytes_per_call));
      DWORD written = 0;
      if (!::WriteFile(handle_, bytes.data(), size, &written, nullptr))
        fail(final_path_, "cannot be written", ::GetLastError());
      bytes = bytes.subspan(written);
    }
  }

  void finish() {
    if (!::FlushFileBuffers(handle_)) fail(final_path_, "cannot be written to the disk", ::GetLastError());
    const bool closed = ::CloseHandle(handle_);
    handle_ = INVALID_HANDLE_VALUE;
    if (!closed) fail(final_path_, "cannot be written to the disk", ::GetLastError());
    // Written through, the new name is on the disk when this returns.
    if (!::MoveFileExW(path_.c_str(), final_path_.c_str(),
                       MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH))
      fail(final_path_, "cannot be replaced", ::GetLastError());
    renamed_ = true;
  }

 private:
  const std::filesystem::path& final_path_;
  std::filesystem::path path_;
  HANDLE handle_ = INVALID_HANDLE_VALUE;
  bool renamed_ = false;
};

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
  check_path(path);
  // Others may go on reading, writing, renaming and removing it, as on other systems.
  const HANDLE file =
      ::CreateFileW(path.c_str(), GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                    nullptr, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (file == INVALID_HANDLE_VALUE) fail(path, "cannot be opened", ::GetLastError());
  LARGE_INTEGER size{};
  const bool is_file = ::GetFileType(file) == FILE_TYPE_DISK;
  if (!is_file || !::GetFileSizeEx(file, &size)) {
    const DWORD error = ::GetLastError();
    ::CloseHandle(file);
    if (!is_file) raise(Error::io, "%s: is not a file that can be read", text_of(path).c_str());
    fail(path, "cannot be read as a file", error);
  }
  handle_ = reinterpret_cast<std::intptr_t>(file);
  size_ = static_cast<std::uint64_t>(size.QuadPart);
}

InputFile::~InputFile() {
  ::CloseHandle(handle_of(handle_));
}

void InputFile::read_block(std::span<std::byte> bytes, std::uint64_t offset) const {
  while (!bytes.empty()) {
    OVERLAPPED place{};
    place.Offset = static_cast<DWORD>(offset);
    place.OffsetHigh = static_cast<DWORD>(offset >> 32);
    const auto size = static_cast<DWORD>(std::min(bytes.size(), max_bytes_per_call));
    DWORD count = 0;
    if (!::ReadFile(handle_of(handle_), bytes.data(), size, &count, &place) &&
        ::GetLastError() != ERROR_HANDLE_EOF)
      fail(path_, "cannot be read", ::GetLastError());
    if (count == 0) fail(path_, "became shorter while it was read", ERROR_HANDLE_EOF);
    bytes = bytes.subspan(count);
    offset += count;
  }
}

std::shared_ptr<const std::byte> InputFile::map() const {
  const HANDLE mapping = ::CreateFileMappingW(handle_of(handle_), nullptr, PAGE_READONLY, 0, 0, nullptr);
  if (mapping == nullptr) fail(path_, "cannot be mapped", ::GetLastError());
  const void* const memory = ::MapViewOfFile(mapping, FILE_MAP_READ, 0, 0, 0);
  const DWORD error = ::GetLastError();
  ::CloseHandle(mapping);  // the view keeps it
  if (memory == nullptr) fail(path_, "cannot be mapped", error);
  return {static_cast<const std::byte*>(memory), [](const std::byte* mapped) { ::UnmapViewOfFile(mapped); }};
}

void replace_file(const std::filesystem::path& path, std::span<const std::span<const std::byte>> pieces) {
  check_path(path);
  const std::filesystem::path target = follow_links(path);
  TemporaryFile file(target);
  for (const auto& piece : pieces) file.write(piece);
  file.finish();
}

}  // namespace kerf

#endif
