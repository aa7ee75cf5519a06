#include "workbench/formats/gltf/buffers.hpp"

#include <algorithm>
#include <array>
#include <system_error>

#include <meshoptimizer.h>

namespace workbench::gltf {
namespace {

using kerf::Error;

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// A URI's %20 as the byte that it stands for (RFC 3986, section 2.1); a % that stands for nothing stays.
std::string decode_percents(std::string_view uri) {
  std::string bytes;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
    bytes.push_back(low >= 0 ? static_cast<char>(16 * high + low) : uri[i]);
    if (low >= 0) i += 2;
  }
  return bytes;
}

// The digits of both alphabets of RFC 4648; 64 is no digit.
constexpr std::array<std::uint8_t, 256> base64_digits = [] {
  std::array<std::uint8_t, 256> digits{};
  for (std::uint8_t& digit : digits) digit = 64;
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < alphabet.size(); ++i)
    digits[static_cast<unsigned char>(alphabet[i])] = static_cast<std::uint8_t>(i);
  digits['-'] = 62;
  digits['_'] = 63;
  return digits;
}();

bool ends_with_base64(std::string_view head) {
  constexpr std::string_view wanted = ";base64";
  if (head.size() < wanted.size()) return false;
  return std::equal(wanted.begin(), wanted.end(), head.end() - wanted.size(), [](char a, char b) {
    return a == (b >= 'A' && b <= 'Z' ? static_cast<char>(b - 'A' + 'a') : b);
  });
}

}  // namespace

// RFC 2397: data:MEDIA-TYPE;base64,DIGITS or data:MEDIA-TYPE,BYTES. Padding may be missing.
std::string Buffers::decode_data_uri(const Object& object, std::string_view uri) const {
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos)
    document_.raise("{}: a data URI without a comma before its data", object.name);
  const std::string_view data = uri.substr(comma + 1);
  if (!ends_with_base64(uri.substr(0, comma))) return decode_percents(data);
  std::string bytes;
  bytes.reserve(data.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const std::uint8_t digit = base64_digits[static_cast<unsigned char>(data[i])];
    if (digit == 64) {
      if (data[i] == ' ' || (data[i] >= '\t' && data[i] <= '\r')) continue;  // the text was broken into lines
      if (data.find_first_not_of('=', i) == std::string_view::npos) break;   // the padding at the end
      document_.raise("{}: no base64 from character {} of {}", object.name, i, data.size());
    }
    bits = bits << 6 | digit;
    if ((count += 6) >= 8) bytes.push_back(static_cast<char>(bits >> (count -= 8) & 0xff));
  }
  return bytes;
}

void Buffers::read(Buffer& buffer, const Object& object, std::uint64_t number) {
  const auto length = document_.whole(object, "byteLength");
  const std::string* const uri = document_.find_text(object, "uri");
  if (uri == nullptr) {
    if (number != 0 || !binary_chunk_)
      document_.raise("{} has no uri, and is not the binary chunk of a .glb file", object.name);
    buffer.bytes = *binary_chunk_;
  } else if (uri->starts_with("data:")) {
    buffer.decoded = decode_data_uri(object, *uri);
    buffer.bytes = buffer.decoded;
  } else {
    // By the standard a URI's percents are encoded; some writers leave names as they are.
    const std::filesystem::path folder = document_.file().parent_path();
    std::filesystem::path path = folder / decode_percents(*uri);
    std::error_code error;
    if (!std::filesystem::exists(path, error) && std::filesystem::exists(folder / *uri, error))
      path = folder / *uri;
    if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
      document_.raise(Error::io, "{}: {} is not a regular file", object.name, path.string());
    try {
      buffer.file = std::make_unique<FileBytes>(
          path, path.extension() == ".gz" ? FileBytes::Packing::maybe_gzipped : FileBytes::Packing::none);
    } catch (const Error& e) {
      document_.raise(e.code(), "{}: {}", object.name, e.what());
    }
    buffer.bytes = buffer.file->view();
  }
  if (buffer.bytes.size() < length)
    document_.raise("truncated: {} should have {} bytes and has {}", object.name, length,
                    buffer.bytes.size());
  buffer.bytes = buffer.bytes.substr(0, length);
  total_bytes_ += length;
}

std::string_view Buffers::buffer(std::uint64_t number, std::string_view by) {
  const Object object = document_.item("buffers", number, by);
  Buffer& buffer = buffers_[number];
  if (!buffer.is_read) read(buffer, object, number);
  buffer.is_read = true;
  return buffer.bytes;
}

// The bytes that a view, or the extension of a packed one, points to.
std::string_view Buffers::part(const Object& view) {
  const std::string_view bytes = buffer(document_.whole(view, "buffer"), view.name);
  const std::uint64_t offset = document_.find_whole(view, "byteOffset").value_or(0);
  const std::uint64_t length = document_.whole(view, "byteLength");
  if (offset > bytes.size() || length > bytes.size() - offset) {
    document_.raise("truncated: {}: {} bytes from byte {} of a buffer of {}", view.name, length, offset,
                    bytes.size());
  }
  return bytes.substr(offset, length);
}

Buffers::View Buffers::view(std::uint64_t number, std::string_view by) {
  const Object object = document_.item("bufferViews", number, by);
  std::optional<View>& view = views_[number];
  if (!view) {
    auto packed = document_.find_extension(object, "EXT_meshopt_compression");
    if (!packed) packed = document_.find_extension(object, "KHR_meshopt_compression");
    view = packed ? unpack(object, *packed)
                  : View{part(object), document_.find_whole(object, "byteStride").value_or(0)};
  }
  return *view;
}

// EXT_meshopt_compression: `count` elements of `byteStride` bytes, packed by meshoptimizer's codecs.
Buffers::View Buffers::unpack(const Object& view, const Object& extension) {
  const std::string_view packed = part(extension);
  const std::uint64_t count = document_.whole(extension, "count"),
                      stride = document_.whole(extension, "byteStride");
  const std::string& mode = document_.text(extension, "mode");
  const std::string* const named = document_.find_text(extension, "filter");
  const std::string filter = named == nullptr ? "NONE" : *named;
  const bool is_attributes = mode == "ATTRIBUTES", is_triangles = mode == "TRIANGLES",
             is_indices = mode == "INDICES";
  if (!is_attributes && !is_triangles && !is_indices)
    document_.raise("{}: '{}' is not a mode", extension.name, mode.substr(0, 40));
  if (is_attributes ? stride == 0 || stride > 256 || stride % 4 != 0 : stride != 2 && stride != 4)
    document_.raise("{}: a byteStride of {} cannot be", extension.name, stride);
  // What the codecs can make of so many bytes: an index or a triangle from one, and 64 vertices' bytes from
  // one.
  const std::uint64_t max_count = is_attributes  ? 64 * packed.size() / stride + 256
                                  : is_triangles ? 3 * packed.size()
                                                 : packed.size();
  if (count > max_count || (is_triangles && count % 3 != 0))
    document_.raise("{}: {} elements cannot be in {} bytes", extension.name, count, packed.size());

  std::string& bytes = unpacked_.emplace_back(count * stride, '\0');
  const auto* const from = reinterpret_cast<const unsigned char*>(packed.data());
  const int wrong =
      is_attributes  ? meshopt_decodeVertexBuffer(bytes.data(), count, stride, from, packed.size())
      : is_triangles ? meshopt_decodeIndexBuffer(bytes.data(), count, stride, from, packed.size())
                     : meshopt_decodeIndexSequence(bytes.data(), count, stride, from, packed.size());
  if (wrong != 0)
    document_.raise("{}: its packed bytes are damaged, or of a version that is not known", extension.name);
  if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) {
    meshopt_decodeFilterOct(bytes.data(), count, stride);
  } else if (filter == "QUATERNION" && stride == 8) {
    meshopt_decodeFilterQuat(bytes.data(), count, stride);
  } else if (filter == "EXPONENTIAL" && stride % 4 == 0) {
    meshopt_decodeFilterExp(bytes.data(), count, stride);
  } else if (filter != "NONE") {
    document_.raise("{}: the filter '{}' with a byteStride of {} is not known", extension.name,
                    filter.substr(0, 40), stride);
  }
  ++unpacked_views_;
  const std::uint64_t length = document_.find_whole(view, "byteLength").value_or(bytes.size());
  return {std::string_view(bytes).substr(0, length), document_.find_whole(view, "byteStride").value_or(0)};
}

}  // namespace workbench::gltf
