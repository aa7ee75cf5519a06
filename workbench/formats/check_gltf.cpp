#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "workbench/base/raise.hpp"
#include "workbench/formats/checks.hpp"
#include "workbench/formats/read_bytes.hpp"

namespace workbench {
namespace {

using kerf::Error;
using Json = nlohmann::json;

/// glTF nests a dozen levels deep. A file of nothing but brackets must not exhaust the stack of a reader.
constexpr int max_nesting = 64;
constexpr std::size_t max_node_depth = 1000;

/// assimp keeps the offset of a URI's data in a signed byte, and leaks memory if the data are not base64.
constexpr std::size_t max_data_head = 126;

constexpr std::string_view base64_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

class GltfCheck {
 public:
  GltfCheck(const std::filesystem::path& file, std::string_view binary_chunk)
      : file_(file), binary_chunk_(binary_chunk) {}

  void run(std::string_view text) {
    // Of two members of one name assimp reads the first and this parser the last, so there may not be two.
    std::vector<std::set<std::string>> members;
    const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
      if (depth > max_nesting) raise(Error::bad_format, file_, "is nested too deeply");
      if (event == Json::parse_event_t::object_start) members.emplace_back();
      if (event == Json::parse_event_t::object_end) members.pop_back();
      if (event == Json::parse_event_t::key && !members.back().insert(value.get<std::string>()).second)
        raise(Error::bad_format, file_, "has two members {} in one object", value.dump());
      return true;
    };
    try {
      gltf_ = Json::parse(text, watch);
      if (!gltf_.is_object()) raise(Error::bad_format, file_, "is not a JSON object");
      check_nodes();
      for (std::size_t i = 0; i < list(gltf_, "buffers").size(); ++i) buffer(i);
      check_images();
      const Json& meshes = list(gltf_, "meshes");
      for (std::size_t i = 0; i < meshes.size(); ++i) check_mesh(i, meshes[i]);
    } catch (const Json::exception& e) {
      const std::string_view what = e.what();  // begins with the name of the exception in brackets
      raise(Error::bad_format, file_, "not a valid glTF file: {}",
            what.substr(std::min(what.size(), what.find("] ") + 2)));
    }
  }

 private:
  static const Json& list(const Json& object, const char* key) {
    static const Json empty = Json::array();
    const auto found = object.find(key);
    return found == object.end() ? empty : *found;
  }

  std::uint64_t to_whole(const Json& value) const {
    if (!value.is_number_unsigned())
      raise(Error::bad_format, file_, "{} stands where a whole number should", value.dump());
    return value.get<std::uint64_t>();
  }

  const Json& item(const char* key, std::uint64_t i) const {
    const Json& items = list(gltf_, key);
    if (i >= items.size())
      raise(Error::bad_format, file_, "there is no {}[{}]: {} has {} items", key, i, key, items.size());
    return items[i];
  }

  // Nodes must form a forest (glTF 2.0, section 3.5.2): assimp follows a cycle for ever.
  void check_nodes() const {
    const Json& nodes = list(gltf_, "nodes");
    std::vector<std::uint64_t> parent(nodes.size(), nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      for (const Json& child : list(nodes[i], "children")) {
        const auto c = to_whole(child);
        item("nodes", c);
        if (parent[c] != nodes.size())
          raise(Error::bad_format, file_, "nodes[{}] has two parents, {} and {}", c, parent[c], i);
        parent[c] = i;
      }
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      std::size_t depth = 0;
      for (std::uint64_t up = parent[i]; up != nodes.size(); up = parent[up]) {
        if (++depth > max_node_depth)
          raise(Error::bad_format, file_, "nodes[{}] is its own ancestor, or too deep", i);
      }
    }
  }

  // Pictures are of no use here, but assimp decodes them.
  void check_images() const {
    const Json& images = list(gltf_, "images");
    for (std::size_t i = 0; i < images.size(); ++i) {
      const std::string uri = images[i].value("uri", "");
      if (uri.starts_with("data:")) data_of(fmt::format("images[{}]", i), uri);
    }
  }

  void check_mesh(std::size_t number, const Json& mesh) {
    const Json& primitives = list(mesh, "primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const Json& primitive = primitives[i];
      const auto attributes = primitive.find("attributes");
      if (attributes == primitive.end() || !attributes->contains("POSITION") ||
          !primitive.contains("indices"))
        continue;
      const Json& positions = item("accessors", to_whole(attributes->at("POSITION")));
      const Json& indices = item("accessors", to_whole(primitive["indices"]));
      if (!indices.contains("bufferView") || indices.contains("sparse"))
        continue;  // indices that are zeros, except a few
      check_indices(fmt::format("meshes[{}].primitives[{}]", number, i), indices,
                    to_whole(positions.at("count")));
    }
  }

  void check_indices(const std::string& place, const Json& accessor, std::uint64_t vertices) {
    const auto type = to_whole(accessor.at("componentType"));
    const std::size_t size = type == 5121 ? 1 : type == 5123 ? 2 : type == 5125 ? 4 : 0;
    if (size == 0) raise(Error::bad_format, file_, "{}: indices of component type {}", place, type);
    const Json& view = item("bufferViews", to_whole(accessor["bufferView"]));
    const std::string_view bytes = buffer(to_whole(view.at("buffer")));
    const auto count = to_whole(accessor.at("count"));
    const auto stride = to_whole(view.value("byteStride", Json(size)));
    const auto first =
        to_whole(view.value("byteOffset", Json(0u))) + to_whole(accessor.value("byteOffset", Json(0u)));
    constexpr std::uint64_t max_offset = std::uint64_t{1} << 40;  // beyond it the sum below could wrap
    if (first > max_offset || stride > 255 || count > max_offset ||
        first + count * stride > bytes.size() + stride - size) {
      raise(Error::bad_format, file_, "truncated: {}: {} indices from byte {} of a buffer of {}", place,
            count, first, bytes.size());
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      std::uint32_t index = 0;
      for (std::size_t k = size; k-- > 0;) {
        index = index << 8 | static_cast<unsigned char>(bytes[first + i * stride + k]);
      }
      if (index >= vertices) {
        raise(Error::index_out_of_range, file_, "{}: index {} names vertex {}, but there are {}", place, i,
              index, vertices);
      }
    }
  }

  std::string_view buffer(std::uint64_t number) {
    const Json& buffer = item("buffers", number);
    buffers_.resize(list(gltf_, "buffers").size());
    if (!buffers_[number].empty()) return buffers_[number];
    const auto length = to_whole(buffer.at("byteLength"));
    std::string& bytes = buffers_[number];
    if (!buffer.contains("uri")) {
      bytes = binary_chunk_;
    } else if (const auto uri = buffer["uri"].get<std::string>(); uri.starts_with("data:")) {
      bytes = decode_base64(data_of(fmt::format("buffers[{}]", number), uri));
    } else {
      try {
        bytes = read_bytes(file_.parent_path() / decode_percents(uri));
      } catch (const Error& e) {
        raise(e.code(), file_, "buffers[{}]: {}", number, e.what());
      }
    }
    if (bytes.size() < length) {
      raise(Error::bad_format, file_, "truncated: buffers[{}] should have {} bytes and has {}", number,
            length, bytes.size());
    }
    return bytes;
  }

  // The base64 text of a data URI, which follows its comma: groups of four digits, the last one padded with
  // up to two signs.
  std::string_view data_of(const std::string& place, std::string_view uri) const {
    const std::size_t comma = uri.find(',');
    const std::string_view head = uri.substr(0, std::min(uri.size(), comma));
    if (comma == std::string_view::npos || comma > max_data_head || !head.ends_with(";base64"))
      raise(Error::bad_format, file_,
            "{}: a data URI that does not begin like data:application/octet-stream;base64,", place);
    const std::string_view text = uri.substr(comma + 1);
    const std::size_t digits = std::min(text.size(), text.find_first_not_of(base64_digits));
    if (text.size() % 4 != 0 || text.size() - digits > 2 ||
        text.find_first_not_of('=', digits) != std::string_view::npos) {
      raise(Error::bad_format, file_, "{}: no base64 from character {} of {}", place, digits, text.size());
    }
    return text;
  }

  static std::string decode_base64(std::string_view text) {
    std::string bytes;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
      const std::size_t digit = base64_digits.find(c);
      if (digit == std::string_view::npos) break;  // the padding at the end
      bits = bits << 6 | static_cast<std::uint32_t>(digit);
      if ((count += 6) >= 8) bytes.push_back(static_cast<char>(bits >> (count -= 8) & 0xff));
    }
    return bytes;
  }

  static std::string decode_percents(std::string_view uri) {
    std::string path;
    for (std::size_t i = 0; i < uri.size(); ++i) {
      unsigned value = 0;
      if (uri[i] == '%' && i + 2 < uri.size() && std::sscanf(uri.data() + i + 1, "%2x", &value) == 1) {
        path.push_back(static_cast<char>(value));
        i += 2;
      } else {
        path.push_back(uri[i]);
      }
    }
    return path;
  }

  const std::filesystem::path& file_;
  std::string_view binary_chunk_;
  Json gltf_;
  std::vector<std::string> buffers_;
};

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 4; i-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes[at + i]);
  return word;
}

}  // namespace

void check_gltf(const std::filesystem::path& file, std::string_view json, std::string_view binary_chunk) {
  GltfCheck(file, binary_chunk).run(json);
}

// A header of magic, version and length is followed by chunks of length, type and bytes (glTF 2.0,
// section 4.4).
void check_glb(const std::filesystem::path& file, std::string_view bytes) {
  constexpr std::size_t header_bytes = 12, chunk_header_bytes = 8;
  if (!bytes.starts_with("glTF")) raise(Error::bad_format, file, "does not begin with the word glTF");
  if (bytes.size() < header_bytes + chunk_header_bytes)
    raise(Error::bad_format, file, "truncated: has only {} bytes", bytes.size());
  if (word_at(bytes, 4) != 2)
    raise(Error::bad_format, file, "has version {}; only version 2 is known", word_at(bytes, 4));
  if (word_at(bytes, 8) != bytes.size()) {
    raise(Error::bad_format, file, "{}: the header promises {} bytes, but there are {}",
          word_at(bytes, 8) > bytes.size() ? "truncated" : "too long", word_at(bytes, 8), bytes.size());
  }
  std::string_view chunks[2];
  std::size_t at = header_bytes;
  for (std::string_view& chunk : chunks) {
    if (at == bytes.size()) break;
    if (bytes.size() - at < chunk_header_bytes ||
        word_at(bytes, at) > bytes.size() - at - chunk_header_bytes) {
      raise(Error::bad_format, file, "truncated: the chunk at byte {} goes beyond the end at {}", at,
            bytes.size());
    }
    chunk = bytes.substr(at + chunk_header_bytes, word_at(bytes, at));
    at += chunk_header_bytes + chunk.size();
  }
  check_gltf(file, chunks[0], chunks[1]);
}

}  // namespace workbench
