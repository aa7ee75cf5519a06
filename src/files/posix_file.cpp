// Files of POSIX systems.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/raise.hpp"
#include "files/paths.hpp"
#include "files/system_file.hpp"

namespace kerf {
namespace {

// One call moves at most this many bytes. The system's own limit is 2^31 - 4096.
constexpr std::size_t max_bytes_per_call = std::size_t{1} << 30;

// For a failed call of the system, whose `errno` was `error`.
[[noreturn]] void fail(const std::filesystem::path& path, const char* what, int error) {
  raise(Error::io, "%s: %s: %s", path.c_str(), what, std::strerror(error));
}

// The new file until it has its final name. It is removed if it never gets it. Devices, pipes and directories
// are not replaced. The new file has the permissions of the old one.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& final_path) : final_path_(final_path) {
    struct stat old {};
    const bool replaces = ::stat(final_path.c_str(), &old) == 0;
    if (replaces && !S_ISREG(old.st_mode))
      raise(Error::io, "%s: is not a file that can be replaced", final_path.c_str());
    const mode_t mode = replaces ? old.st_mode & 0777 : 0666;
    descriptor_ = open_without_name(final_path, mode);
    has_name_ = descriptor_ < 0;
    while (descriptor_ < 0) {
      path_ = temporary_name(final_path);
      descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
      if (descriptor_ < 0 && errno != EEXIST) break;
    }
    if (descriptor_ < 0) fail(final_path, "cannot be written", errno);
    if (replaces) (void)::fchmod(descriptor_, mode);  // file systems without permissions refuse
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (has_name_) ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), std::min(bytes.size(), max_bytes_per_call));
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(final_path_, "cannot be written", errno);
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
  }

  void finish() {
    if (::fsync(descriptor_) != 0) fail(final_path_, "cannot be written to the disk", errno);
    if (!has_name_) give_name();
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) fail(final_path_, "cannot be written to the disk", errno);
    if (::rename(path_.c_str(), final_path_.c_str()) != 0) fail(final_path_, "cannot be replaced", errno);
    has_name_ = false;
  }

 private:
  // A file that has no name yet is gone with a program that is killed while it writes. Negative where the
  // system has none of that kind, or could not name it later for want of /proc.
  static int open_without_name([[maybe_unused]] const std::filesystem::path& final_path,
                               [[maybe_unused]] mode_t mode) {
#ifdef O_TMPFILE
    const std::filesystem::path folder = final_path.parent_path() / ".";
    if (::access("/proc/self/fd", X_OK) == 0)
      return ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, mode);
#endif
    return -1;
  }

  // A link takes the place of no other file, a renamed file does.
  void give_name() {
    const std::string open_file = "/proc/self/fd/" + std::to_string(descriptor_);
    do {
      path_ = temporary_name(final_path_);
      has_name_ = ::linkat(AT_FDCWD, open_file.c_str(), AT_FDCWD, path_.c_str(), AT_SYMLINK_FOLLOW) == 0;
    } while (!has_name_ && errno == EEXIST);
    if (!has_name_) fail(final_path_, "cannot be written", errno);
  }

  const std::filesystem::path& final_path_;
  std::filesystem::path path_;  // if it has a name
  int descriptor_ = -1;
  bool has_name_ = false;
};

// The new name is on the disk once its directory is. File systems that need no such call for directories
// answer EINVAL.
void sync_directory(const std::filesystem::path& path) {
  const std::filesystem::path directory =
      path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const int descriptor = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) fail(path, "its directory cannot be opened", errno);
  const bool synced = ::fsync(descriptor) == 0 || errno == EINVAL;
  const int error = errno;
  ::close(descriptor);
  if (!synced) fail(path, "its directory cannot be written to the disk", error);
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
  check_path(path);
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) fail(path, "cannot be opened", errno);
  struct stat status {};
  const bool known = ::fstat(descriptor, &status) == 0;
  if (!known || !S_ISREG(status.st_mode)) {
    const int error = known ? EISDIR : errno;
    ::close(descriptor);
    if (known && !S_ISDIR(status.st_mode))
      raise(Error::io, "%s: is not a file that can be read", path.c_str());
    fail(path, "cannot be read as a file", error);
  }
  handle_ = descriptor;
  size_ = static_cast<std::uint64_t>(status.st_size);
}

InputFile::~InputFile() {
  ::close(static_cast<int>(handle_));
}

void InputFile::read_block(std::span<std::byte> bytes, std::uint64_t offset) const {
  while (!bytes.empty()) {
    const ssize_t count = ::pread(static_cast<int>(handle_), bytes.data(),
                                  std::min(bytes.size(), max_bytes_per_call), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(path_, "cannot be read", errno);
    if (count == 0) fail(path_, "became shorter while it was read", EIO);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
}

std::shared_ptr<const std::byte> InputFile::map() const {
  const auto bytes = static_cast<std::size_t>(size_);
  if (bytes != size_) fail(path_, "cannot be mapped", EFBIG);
  void* memory = ::mmap(nullptr, bytes, PROT_READ, MAP_PRIVATE, static_cast<int>(handle_), 0);
  if (memory == MAP_FAILED) fail(path_, "cannot be mapped", errno);
  return {static_cast<const std::byte*>(memory),
          [bytes](const std::byte* mapped) { ::munmap(const_cast<std::byte*>(mapped), bytes); }};
}

void replace_file(const std::filesystem::path& path, std::span<const std::span<const std::byte>> pieces) {
  check_path(path);
  const std::filesystem::path target = follow_links(path);
  TemporaryFile file(target);
  for (const auto& piece : pieces) file.write(piece);
  file.finish();
  sync_directory(target);
}

}  // namespace kerf
