#include "output.hpp"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <list>
#include <memory>
#include <optional>
#include <random>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

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

namespace fs = std::filesystem;

// The file that `file` stands for: the end of a chain of symbolic links, so that links stay.
fs::path follow_links(fs::path file) {
  std::error_code error;
  constexpr int max_links = 40;  // as many as the system follows
  for (int i = 0; i < max_links && fs::is_symlink(file, error); ++i)
    file = file.parent_path() / fs::read_symlink(file, error);
  return file;
}

// Devices and pipes are written as they are; files are replaced.
bool is_replaced(const fs::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) != 0 || S_ISREG(status.st_mode);
}

// Files and empty folders that a signal which ends the program removes before it does. Nothing but atomics is
// read by the handler: whatever it interrupts, it may take no lock and no memory.
constexpr std::size_t max_unfinished = 64;
std::atomic<const char*> unfinished[max_unfinished] = {};

extern "C" void remove_unfinished(int signal) {
  for (std::size_t i = max_unfinished; i-- > 0;) {  // what lies in a folder before the folder
    const char* const path = unfinished[i].load();
    if (path != nullptr && ::unlink(path) != 0) ::rmdir(path);
  }
  ::raise(signal);  // as if there were no handler: it was reset
}

void watch_signals() {
  static const bool once = [] {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      struct sigaction action {};
      if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) continue;
      action.sa_handler = remove_unfinished;
      action.sa_flags = static_cast<int>(SA_RESETHAND);
      ::sigaction(signal, &action, nullptr);
    }
    return true;
  }();
  (void)once;
}

// While this lives, a signal removes `path`. Later ones stand behind earlier ones.
class Unfinished {
 public:
  explicit Unfinished(std::string path) : path_(std::move(path)) {
    watch_signals();
    while (place_ < max_unfinished && unfinished[place_].load() != nullptr) ++place_;
    if (place_ < max_unfinished) unfinished[place_] = path_.c_str();
  }
  ~Unfinished() {
    if (place_ < max_unfinished) unfinished[place_] = nullptr;
  }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

 private:
  const std::string path_;
  std::size_t place_ = 0;
};

// A new file beside `final_path`, with its permissions. It is removed unless it is renamed to it: whatever
// goes wrong, what was there stays.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& final_path) : final_path_(final_path) {
    struct stat old {};
    const bool replaces = ::stat(final_path.c_str(), &old) == 0;
    const mode_t mode = replaces ? old.st_mode & 0777 : 0666;
    constexpr std::size_t max_name_bytes = 240;  // of the 255 that a system allows
    const std::string name = final_path.filename().string().substr(0, max_name_bytes);
    std::random_device random;
    int descriptor;
    do {
      path_ = final_path.parent_path() / fmt::format("{}.{}.tmp", name, random());
      unfinished_.emplace(path_.string());
      descriptor = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    } while (descriptor < 0 && errno == EEXIST);
    if (descriptor < 0) raise_io(final_path.string(), "cannot be written", errno);
    if (replaces) (void)::fchmod(descriptor, mode);  // file systems without permissions refuse
    stream_ = Stream(::fdopen(descriptor, "wb"), &std::fclose);
  }
  ~TemporaryFile() {
    stream_.reset();
    if (!renamed_) ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write_and_rename(std::string_view bytes) {
    const std::string name = final_path_.string();
    write(stream_.get(), name, bytes);
    if (::fsync(fileno(stream_.get())) != 0) raise_io(name, "cannot be written to the disk", errno);
    if (std::fclose(stream_.release()) != 0) raise_io(name, "cannot be written", errno);
    if (::rename(path_.c_str(), final_path_.c_str()) != 0) raise_io(name, "cannot be written", errno);
    renamed_ = true;
  }

 private:
  fs::path final_path_, path_;
  std::optional<Unfinished> unfinished_;  // ends after the file is removed or renamed
  Stream stream_{nullptr, &std::fclose};
  bool renamed_ = false;
};

}  // namespace

void require_writable(const std::string& file) {
  if (file == standard_output) return;
  const fs::path place = follow_links(file);
  std::error_code ignored;
  if (fs::is_directory(place, ignored)) raise_io(file, "cannot be written", EISDIR);
  if (is_replaced(place)) {
    const TemporaryFile removed_at_once(place);
  } else {
    open(file, "ab");
  }
}

void require_writable_directory(const std::string& directory) {
  const fs::path place = fs::path(directory);
  std::error_code error;
  if (fs::is_directory(place, error)) return require_writable((place / "index.html").string());
  // The nearest folder above that is there must take another.
  fs::path above = fs::absolute(place).lexically_normal();
  while (!fs::exists(above, error) && above.has_relative_path()) above = above.parent_path();
  if (!fs::is_directory(above, error)) raise_io(directory, "the directory cannot be made", ENOTDIR);
  if (::access(above.c_str(), W_OK | X_OK) != 0) raise_io(directory, "the directory cannot be made", errno);
}

void write_in_directory(const std::string& directory, const std::string& name, std::string_view bytes) {
  // Those that are made here are removed again if the file cannot be written.
  std::vector<fs::path> made;
  std::error_code error;
  for (fs::path part = fs::path(directory); !part.empty() && !fs::exists(part, error);
       part = part.parent_path())
    made.push_back(part);
  std::list<Unfinished> unfinished_folders;
  for (auto part = made.rbegin(); part != made.rend(); ++part)
    unfinished_folders.emplace_back(part->string());
  fs::create_directories(directory, error);
  if (error) raise_io(directory, "the directory cannot be made", error.value());
  try {
    write_output((fs::path(directory) / name).string(), bytes);
  } catch (const kerf::Error&) {
    for (const fs::path& part : made) fs::remove(part, error);
    throw;
  }
}

void write_output(const std::string& file, std::string_view bytes) {
  if (file == standard_output) return write(stdout, "standard output", bytes);
  const fs::path place = follow_links(file);
  if (is_replaced(place)) return TemporaryFile(place).write_and_rename(bytes);
  const Stream stream = open(file, "wb");
  write(stream.get(), file, bytes);
}

}  // namespace kerf_tool
