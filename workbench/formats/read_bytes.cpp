#include "workbench/formats/read_bytes.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <fmt/format.h>
#include <kerf/error.hpp>
#include <zlib.h>

namespace workbench {
namespace {

using kerf::Error;

/// No scene file is this large; what unpacks to more was made to fill the memory.
constexpr std::size_t largest_unpacked = std::size_t{1} << 34;

std::string read_plain(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw Error(Error::io, fmt::format("{}: is a directory", file.string()));
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!stream) throw Error(Error::io, fmt::format("{}: {}", file.string(), std::strerror(errno)));
  std::string bytes;
  std::array<char, 1 << 16> part;
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), stream.get())) {
    bytes.append(part.data(), count);
  }
  if (std::ferror(stream.get())) {
    throw Error(Error::io, fmt::format("{}: reading stopped at byte {}: {}", file.string(), bytes.size(),
                                       std::strerror(errno)));
  }
  if (bytes.empty()) throw Error(Error::bad_format, fmt::format("{}: is empty", file.string()));
  return bytes;
}

// A gzip file is one or more gzip members, one behind the other (RFC 1952, section 2.2).
std::string unpack(const std::filesystem::path& file, const std::string& packed) {
  z_stream stream{};
  constexpr int gzip_only = 16 + MAX_WBITS;
  if (inflateInit2(&stream, gzip_only) != Z_OK) throw Error(Error::out_of_memory, "no memory to unpack with");
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);

  std::string bytes;
  std::array<char, 1 << 16> part;
  std::size_t begin = 0;  // of the packed bytes that zlib has not been given yet
  for (;;) {
    if (stream.avail_in == 0) {
      const std::size_t count = std::min(packed.size() - begin, std::size_t{1} << 30);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + begin));
      stream.avail_in = static_cast<uInt>(count);
      begin += count;
    }
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    const int result = inflate(&stream, Z_NO_FLUSH);
    bytes.append(part.data(), part.size() - stream.avail_out);
    const std::size_t done = begin - stream.avail_in;
    if (bytes.size() > largest_unpacked) {
      throw Error(Error::bad_format,
                  fmt::format("{}: unpacks to more than {} bytes", file.string(), largest_unpacked));
    }
    if (result == Z_STREAM_END) {
      if (done == packed.size()) break;
      inflateReset(&stream);
    } else if (result == Z_BUF_ERROR && done == packed.size()) {
      throw Error(Error::bad_format,
                  fmt::format("{}: truncated: the gzip data end at byte {} before their end mark",
                              file.string(), done));
    } else if (result != Z_OK) {
      throw Error(Error::bad_format, fmt::format("{}: damaged gzip data before byte {}: {}", file.string(),
                                                 done, stream.msg ? stream.msg : "cannot be unpacked"));
    }
  }
  if (bytes.empty()) throw Error(Error::bad_format, fmt::format("{}: is empty once unpacked", file.string()));
  return bytes;
}

}  // namespace

std::string read_bytes(const std::filesystem::path& file) {
  std::string bytes = read_plain(file);
  const bool is_gzipped = bytes.size() >= 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
  return is_gzipped ? unpack(file, bytes) : bytes;
}

}  // namespace workbench
