#include "workbench/formats/file_bytes.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>

#include <fcntl.h>
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

Mapping read_stream(const std::filesystem::path& file, int descriptor) {
  CollectedBytes bytes(file);
  std::array<char, 1 << 16> chunk;
  for (;;) {
    const ssize_t count = ::read(descriptor, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0)
      raise(Error::io, file, "reading stopped at byte {}: {}", bytes.size(), std::strerror(errno));
    if (count == 0) return bytes.take();
    bytes.append({chunk.data(), static_cast<std::size_t>(count)});
  }
}

// A gzip file is a sequence of one or more gzip members (RFC 1952, section 2.2).
Mapping unpack(const std::filesystem::path& file, const Mapping& gzipped) {
  z_stream stream{};
  constexpr int gzip_only = 16 + MAX_WBITS;
  if (inflateInit2(&stream, gzip_only) != Z_OK) raise(Error::out_of_memory, file, "no memory to unpack it");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);

  const std::string_view packed = gzipped.view();
  CollectedBytes unpacked(file);
  std::array<char, 1 << 17> chunk;
  std::size_t begin = 0;  // of the packed bytes that zlib has not seen yet
  for (;;) {
    if (stream.avail_in == 0) {
      const std::size_t count = std::min(packed.size() - begin, std::size_t{1} << 20);
      if (begin != 0) gzipped.release(packed.substr(0, begin));
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + begin));
      stream.avail_in = static_cast<uInt>(count);
      begin += count;
    }
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    const int result = inflate(&stream, Z_NO_FLUSH);
    unpacked.append({chunk.data(), chunk.size() - stream.avail_out});
    const std::size_t done = begin - stream.avail_in;
    if (unpacked.size() > max_unpacked_bytes)
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
  if (unpacked.size() == 0) raise(Error::bad_format, file, "is empty when unpacked");
  return unpacked.take();
}

}  // namespace

FileBytes::FileBytes(const std::filesystem::path& file, Packing packing) {
  const Descriptor descriptor(file);
  struct stat status {};
  if (::fstat(descriptor.number(), &status) != 0) raise(Error::io, file, "{}", std::strerror(errno));
  if (S_ISDIR(status.st_mode)) raise(Error::io, file, "is a directory");
  bytes_ = S_ISREG(status.st_mode) && status.st_size > 0
               ? Mapping::of_file(file, descriptor.number(), static_cast<std::size_t>(status.st_size))
               : read_stream(file, descriptor.number());
  if (view().empty()) raise(Error::bad_format, file, "is empty");
  if (packing == Packing::maybe_gzipped && view().starts_with("\x1f\x8b")) bytes_ = unpack(file, bytes_);
}

}  // namespace workbench
