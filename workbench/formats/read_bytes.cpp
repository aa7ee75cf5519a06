#include "workbench/formats/read_bytes.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <zlib.h>

#include "workbench/base/raise.hpp"

namespace workbench {
namespace {

using kerf::Error;

/// No scene file is this large: a file that unpacks to more was made to fill the memory.
constexpr std::size_t max_unpacked_bytes = std::size_t{1} << 34;

std::string read_plain(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    raise(Error::io, file, "is a directory");
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!stream) raise(Error::io, file, "{}", std::strerror(errno));
  std::string bytes;
  std::array<char, 1 << 16> chunk;
  while (const std::size_t count = std::fread(chunk.data(), 1, chunk.size(), stream.get())) {
    bytes.append(chunk.data(), count);
  }
  if (std::ferror(stream.get())) {
    raise(Error::io, file, "reading stopped at byte {}: {}", bytes.size(), std::strerror(errno));
  }
  if (bytes.empty()) raise(Error::bad_format, file, "is empty");
  return bytes;
}

// A gzip file is a sequence of one or more gzip members (RFC 1952, section 2.2).
std::string unpack(const std::filesystem::path& file, const std::string& packed) {
  z_stream stream{};
  constexpr int gzip_only = 16 + MAX_WBITS;
  if (inflateInit2(&stream, gzip_only) != Z_OK) raise(Error::out_of_memory, file, "no memory to unpack it");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);

  std::string bytes;
  std::array<char, 1 << 16> chunk;
  std::size_t begin = 0;  // of the packed bytes that zlib has not seen yet
  for (;;) {
    if (stream.avail_in == 0) {
      const std::size_t count = std::min(packed.size() - begin, std::size_t{1} << 30);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + begin));
      stream.avail_in = static_cast<uInt>(count);
      begin += count;
    }
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    const int result = inflate(&stream, Z_NO_FLUSH);
    bytes.append(chunk.data(), chunk.size() - stream.avail_out);
    const std::size_t done = begin - stream.avail_in;
    if (bytes.size() > max_unpacked_bytes) {
      raise(Error::bad_format, file, "unpacks to more than {} bytes", max_unpacked_bytes);
    }
    if (result == Z_STREAM_END) {
      if (done == packed.size()) break;
      inflateReset(&stream);
    } else if (result == Z_BUF_ERROR && done == packed.size()) {
      raise(Error::bad_format, file, "truncated: the gzip data end at byte {}, before their end mark", done);
    } else if (result != Z_OK) {
      raise(Error::bad_format, file, "damaged gzip data before byte {}: {}", done,
            stream.msg ? stream.msg : "cannot be unpacked");
    }
  }
  if (bytes.empty()) raise(Error::bad_format, file, "is empty when unpacked");
  return bytes;
}

}  // namespace

std::string read_bytes(const std::filesystem::path& file) {
  std::string bytes = read_plain(file);
  const bool is_gzipped = bytes.size() >= 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
  return is_gzipped ? unpack(file, bytes) : bytes;
}

}  // namespace workbench
