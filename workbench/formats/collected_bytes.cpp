#include "workbench/formats/collected_bytes.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "workbench/base/raise.hpp"

namespace workbench {
namespace {

using kerf::Error;

}  // namespace

std::filesystem::path folder_of_large_files() {
  const char* const named = std::getenv("TMPDIR");
  return named != nullptr && *named != '\0' ? named : "/var/tmp";
}

Mapping Mapping::of_file(const std::filesystem::path& file, int descriptor, std::size_t size) {
  void* const place = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (place == MAP_FAILED) raise(Error::io, file, "cannot be mapped: {}", std::strerror(errno));
  ::madvise(place, size, MADV_SEQUENTIAL);
  Mapping mapping;
  mapping.data_ = static_cast<char*>(place);
  mapping.size_ = mapping.reserved_ = size;
  mapping.is_of_file_ = true;
  return mapping;
}

Mapping::~Mapping() {
  if (data_ != nullptr) ::munmap(data_, reserved_);
}

void Mapping::swap(Mapping& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(reserved_, other.reserved_);
  std::swap(is_of_file_, other.is_of_file_);
}

void Mapping::release(std::string_view part) const {
  if (!is_of_file_) return;  // nowhere else to read it again
  static const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const auto begin = (reinterpret_cast<std::uintptr_t>(part.data()) + page - 1) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(part.data() + part.size()) / page * page;
  if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
}

void Mapping::append(const std::filesystem::path& file, std::string_view bytes) {
  if (bytes.empty()) return;
  if (size_ + bytes.size() > reserved_) {
    const std::size_t wanted = std::max({2 * reserved_, size_ + bytes.size(), std::size_t{1} << 20});
    void* const place =
        data_ == nullptr ? ::mmap(nullptr, wanted, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)
                         : ::mremap(data_, reserved_, wanted, MREMAP_MAYMOVE);
    if (place == MAP_FAILED) raise(Error::out_of_memory, file, "no memory for its {} bytes", wanted);
    data_ = static_cast<char*>(place);
    reserved_ = wanted;
  }
  std::memcpy(data_ + size_, bytes.data(), bytes.size());
  size_ += bytes.size();
}

CollectedBytes::~CollectedBytes() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void CollectedBytes::append(std::string_view bytes) {
  if (descriptor_ < 0 && size_ + bytes.size() > in_memory_) begin_file();
  if (descriptor_ < 0)
    memory_.append(file_, bytes);
  else
    write(bytes);
  size_ += bytes.size();
}

void CollectedBytes::begin_file() {
  std::string name = (folder_ / "kerf-XXXXXX").string();
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) raise_no_file();
  ::unlink(name.c_str());
  write(memory_.view());
  memory_ = Mapping();
}

void CollectedBytes::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) raise_no_file();
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void CollectedBytes::raise_no_file() const {
  raise(Error::io, file_,
        "holds more than {} bytes, which need a temporary file, and {} takes none: {}; TMPDIR names another "
        "folder",
        size_, folder_.string(), std::strerror(errno));
}

Mapping CollectedBytes::take() {
  return descriptor_ < 0 ? std::move(memory_) : Mapping::of_file(file_, descriptor_, size_);
}

}  // namespace workbench
