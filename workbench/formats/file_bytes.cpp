#include "workbench/formats/file_bytes.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "workbench/base/raise.hpp"

namespace workbench {
namespace {

using kerf::Error;

/// No scene file is this large: a file that unpacks to more was made to fill the memory.
constexpr std::size_t max_unpacked_bytes = std::size_t{1} << 34;

class Descriptor {
 public:
  explicit Descriptor(const std::filesystem::path& file)
      : number_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (number_ < 0) raise(Error::io, file, "{}", std::strerror(errno));
  }
  ~Descriptor() { ::close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

}  // namespace

FileBytes::FileBytes(const std::filesystem::path& file, Packing packing) : FileBytes() {
  const Descriptor descriptor(file);
  struct stat status {};
  if (::fstat(descriptor.number(), &status) != 0) raise(Error::io, file, "{}", std::strerror(errno));
  if (S_ISDIR(status.st_mode)) raise(Error::io, file, "is a directory");
  FileBytes bytes;
  if (S_ISREG(status.st_mode) && status.st_size > 0) {
    bytes.size_ = bytes.reserved_ = static_cast<std::size_t>(status.st_size);
    void* const place = ::mmap(nullptr, bytes.size_, PROT_READ, MAP_PRIVATE, descriptor.number(), 0);
    if (place == MAP_FAILED) raise(Error::io, file, "cannot be mapped: {}", std::strerror(errno));
    bytes.data_ = static_cast<char*>(place);
    bytes.is_mapped_ = true;
    ::madvise(place, bytes.size_, MADV_SEQUENTIAL);
  } else {
    bytes.read_stream(file, descriptor.number());
  }
  if (bytes.size_ == 0) raise(Error::bad_format, file, "is empty");
  swap(bytes);
  if (packing == Packing::maybe_gzipped && view().starts_with("\x1f\x8b")) unpack(file);
}

FileBytes::~FileBytes() {
  if (data_ != nullptr) ::munmap(data_, reserved_);
}

void FileBytes::swap(FileBytes& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(reserved_, other.reserved_);
  std::swap(is_mapped_, other.is_mapped_);
}

void FileBytes::release(std::string_view part) const {
  if (!is_mapped_) return;  // nowhere else to read it again
  static const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const auto begin = (reinterpret_cast<std::uintptr_t>(part.data()) + page - 1) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(part.data() + part.size()) / page * page;
  if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
}

void FileBytes::append(const std::filesystem::path& file, const char* bytes, std::size_t count) {
  if (count == 0) return;
  if (size_ + count > reserved_) {
    const std::size_t wanted = std::max(2 * reserved_, std::size_t{1} << 20);
    void* const place =
        data_ == nullptr ? ::mmap(nullptr, wanted, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)
                         : ::mremap(data_, reserved_, wanted, MREMAP_MAYMOVE);
    if (place == MAP_FAILED) raise(Error::out_of_memory, file, "no memory for its {} bytes", wanted);
    data_ = static_cast<char*>(place);
    reserved_ = wanted;
  }
  std::memcpy(data_ + size_, bytes, count);
  size_ += count;
}

void FileBytes::read_stream(const std::filesystem::path& file, int descriptor) {
  std::array<char, 1 << 16> chunk;
  for (;;) {
    const ssize_t count = ::read(descriptor, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) raise(Error::io, file, "reading stopped at byte {}: {}", size_, std::strerror(errno));
    if (count == 0) return;
    append(file, chunk.data(), static_cast<std::size_t>(count));
  }
}

// A gzip file is a sequence of one or more gzip members (RFC 1952, section 2.2).
void FileBytes::unpack(const std::filesystem::path& file) {
  z_stream stream{};
  constexpr int gzip_only = 16 + MAX_WBITS;
  if (inflateInit2(&stream, gzip_only) != Z_OK) raise(Error::out_of_memory, file, "no memory to unpack it");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);

  const std::string_view packed = view();
  FileBytes unpacked;
  std::array<char, 1 << 17> chunk;
  std::size_t begin = 0;  // of the packed bytes that zlib has not seen yet
  for (;;) {
    if (stream.avail_in == 0) {
      const std::size_t count = std::min(packed.size() - begin, std::size_t{1} << 20);
      if (begin != 0) release(packed.substr(0, begin));
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + begin));
      stream.avail_in = static_cast<uInt>(count);
      begin += count;
    }
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    const int result = inflate(&stream, Z_NO_FLUSH);
    unpacked.append(file, chunk.data(), chunk.size() - stream.avail_out);
    const std::size_t done = begin - stream.avail_in;
    if (unpacked.size_ > max_unpacked_bytes)
      raise(Error::bad_format, file, "unpacks to more than {} bytes", max_unpacked_bytes);
    if (result == Z_STREAM_END) {
      // What follows the last member and is none, such as zeros of a tape's block, does not count (gzip's own
      // rule).
      if (!packed.substr(done).starts_with("\x1f\x8b")) break;
      inflateReset(&stream);
    } else if (result == Z_BUF_ERROR && done == packed.size()) {
      raise(Error::bad_format, file, "truncated: the gzip data end at byte {}, before their end mark", done);
    } else if (result != Z_OK) {
      raise(Error::bad_format, file, "damaged gzip data before byte {}: {}", done,
            stream.msg ? stream.msg : "cannot be unpacked");
    }
  }
  if (unpacked.size_ == 0) raise(Error::bad_format, file, "is empty when unpacked");
  swap(unpacked);
}

}  // namespace workbench
