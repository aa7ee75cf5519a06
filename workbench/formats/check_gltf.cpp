#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <kerf/error.hpp>
#include <nlohmann/json.hpp>

#include "workbench/formats/checks.hpp"
#include "workbench/formats/read_bytes.hpp"

namespace workbench {
namespace {

using kerf::Error;
using Json = nlohmann::json;

/// glTF nests a dozen levels; a file of nothing but brackets is to exhaust no reader's stack.
constexpr int deepest_nesting = 64;
constexpr std::size_t deepest_node = 1000;

/// assimp keeps where the data of a URI begin in a signed byte, and loses memory where they are not base64.
constexpr std::size_t longest_data_head = 126;

constexpr std::string_view base64_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

class GltfCheck {
 public:
  GltfCheck(const std::filesystem::path& file, std::string_view binary_chunk)
      : file_(file), binary_chunk_(binary_chunk) {}

  void run(std::string_view text) {
    // What is checked must be what assimp reads, which takes the first of two members of a name.
    std::vector<std::set<std::string>> members;
    const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
      if (depth > deepest_nesting) fail("is nested too deeply");
      if (event == Json::parse_event_t::object_start) members.emplace_back();
      if (event == Json::parse_event_t::object_end) members.pop_back();
      if (event == Json::parse_event_t::key && !members.back().insert(value.get<std::string>()).second)
        fail(fmt::format("has two members {} in one object", value.dump()));
      return true;
    };
    try {
      gltf_ = Json::parse(text, watch);
      if (!gltf_.is_object()) fail("is not a JSON object");
      check_nodes();
      for (std::size_t i = 0; i < list(gltf_, "buffers").size(); ++i) buffer(i);
      check_images();
      const Json& meshes = list(gltf_, "meshes");
      for (std::size_t i = 0; i < meshes.size(); ++i) check_mesh(i, meshes[i]);
    } catch (const Json::exception& e) {
      const std::string_view what = e.what();  // behind the name of the exception in brackets
      fail(fmt::format("not a valid glTF file: {}", what.substr(std::min(what.size(), what.find("] ") + 2))));
    }
  }

 private:
  [[noreturn]] void fail(std::string_view what, Error::Code code = Error::bad_format) const {
    throw Error(code, fmt::format("{}: {}", file_.string(), what));
  }

  static const Json& list(const Json& object, const char* key) {
    static const Json empty = Json::array();
    const auto found = object.find(key);
    return found == object.end() ? empty : *found;
  }

  std::uint64_t whole(const Json& value) const {
    if (!value.is_number_unsigned())
      fail(fmt::format("{} stands where a number of something should", value.dump()));
    return value.get<std::uint64_t>();
  }

  const Json& item(const char* key, std::uint64_t i) const {
    const Json& items = list(gltf_, key);
    if (i >= items.size())
      fail(fmt::format("there is no {}[{}]: {} has {} items", key, i, key, items.size()));
    return items[i];
  }

  // Nodes must be a forest, or importing them takes for ever (glTF 2.0, section 3.5.2).
  void check_nodes() const {
    const Json& nodes = list(gltf_, "nodes");
    std::vector<std::uint64_t> parent(nodes.size(), nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      for (const Json& child : list(nodes[i], "children")) {
        const auto c = whole(child);
        item("nodes", c);
        if (parent[c] != nodes.size())
          fail(fmt::format("nodes[{}] has two parents, {} and {}", c, parent[c], i));
        parent[c] = i;
      }
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      std::size_t depth = 0;
      for (std::uint64_t up = parent[i]; up != nodes.size(); up = parent[up]) {
        if (++depth > deepest_node) fail(fmt::format("nodes[{}] is its own ancestor, or too deep", i));
      }
    }
  }

  // Nobody looks at pictures, but they are read.
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
      const Json& positions = item("accessors", whole(attributes->at("POSITION")));
      const Json& indices = item("accessors", whole(primitive["indices"]));
      if (!indices.contains("bufferView") || indices.contains("sparse")) continue;  // zeros, but for a few
      check_indices(fmt::format("meshes[{}].primitives[{}]", number, i), indices,
                    whole(positions.at("count")));
    }
  }

  void check_indices(const std::string& place, const Json& accessor, std::uint64_t vertices) {
    const auto type = whole(accessor.at("componentType"));
    const std::size_t size = type == 5121 ? 1 : type == 5123 ? 2 : type == 5125 ? 4 : 0;
    if (size == 0) fail(fmt::format("{}: indices of component type {}", place, type));
    const Json& view = item("bufferViews", whole(accessor["bufferView"]));
    const std::string_view bytes = buffer(whole(view.at("buffer")));
    const auto count = whole(accessor.at("count"));
    const auto stride = whole(view.value("byteStride", Json(size)));
    const auto first =
        whole(view.value("byteOffset", Json(0u))) + whole(accessor.value("byteOffset", Json(0u)));
    constexpr std::uint64_t largest = std::uint64_t{1} << 40;  // above it the sum below could wrap
    if (first > largest || stride > 255 || count > largest ||
        first + count * stride > bytes.size() + stride - size) {
      fail(fmt::format("truncated: {}: {} indices from byte {} of a buffer of {}", place, count, first,
                       bytes.size()));
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      std::uint32_t index = 0;
      for (std::size_t k = size; k-- > 0;) {
        index = index << 8 | static_cast<unsigned char>(bytes[first + i * stride + k]);
      }
      if (index >= vertices) {
        fail(fmt::format("{}: index {} names vertex {}, but there are {}", place, i, index, vertices),
             Error::index_out_of_range);
      }
    }
  }

  std::string_view buffer(std::uint64_t number) {
    const Json& buffer = item("buffers", number);
    buffers_.resize(list(gltf_, "buffers").size());
    if (!buffers_[number].empty()) return buffers_[number];
    const auto length = whole(buffer.at("byteLength"));
    std::string& bytes = buffers_[number];
    if (!buffer.contains("uri")) {
      bytes = binary_chunk_;
    } else if (const auto uri = buffer["uri"].get<std::string>(); uri.starts_with("data:")) {
      bytes = decode_base64(data_of(fmt::format("buffers[{}]", number), uri));
    } else {
      try {
        bytes = read_bytes(file_.parent_path() / decode_percents(uri));
      } catch (const Error& e) {
        fail(fmt::format("buffers[{}]: {}", number, e.what()), e.code());
      }
    }
    if (bytes.size() < length) {
      fail(fmt::format("truncated: buffers[{}] should have {} bytes and has {}", number, length,
                       bytes.size()));
    }
    return bytes;
  }

  // What follows the comma of a data URI: groups of four digits, the last with up to two signs of padding.
  std::string_view data_of(const std::string& place, std::string_view uri) const {
    const std::size_t comma = uri.find(',');
    const std::string_view head = uri.substr(0, std::min(uri.size(), comma));
    if (comma == std::string_view::npos || comma > longest_data_head || !head.ends_with(";base64"))
      fail(fmt::format("{}: a data URI that does not begin like data:application/octet-stream;base64,",
                       place));
    const std::string_view text = uri.substr(comma + 1);
    const std::size_t digits = std::min(text.size(), text.find_first_not_of(base64_digits));
    if (text.size() % 4 != 0 || text.size() - digits > 2 ||
        text.find_first_not_of('=', digits) != std::string_view::npos) {
      fail(fmt::format("{}: no base64 from character {} of {} on", place, digits, text.size()));
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

// A header of magic, version and length; then chunks of length, type and bytes (glTF 2.0, section 4.4).
void check_glb(const std::filesystem::path& file, std::string_view bytes) {
  const auto fail = [&](const std::string& what) {
    throw Error(Error::bad_format, fmt::format("{}: {}", file.string(), what));
  };
  constexpr std::size_t header_bytes = 12, chunk_header_bytes = 8;
  if (!bytes.starts_with("glTF")) fail("does not begin with the word glTF");
  if (bytes.size() < header_bytes + chunk_header_bytes)
    fail(fmt::format("truncated: has {} bytes only", bytes.size()));
  if (word_at(bytes, 4) != 2) fail(fmt::format("has version {}; known is 2", word_at(bytes, 4)));
  if (word_at(bytes, 8) != bytes.size()) {
    fail(fmt::format("{}: the header promises {} bytes, but there are {}",
                     word_at(bytes, 8) > bytes.size() ? "truncated" : "too long", word_at(bytes, 8),
                     bytes.size()));
  }
  std::string_view chunks[2];
  std::size_t at = header_bytes;
  for (std::string_view& chunk : chunks) {
    if (at == bytes.size()) break;
    if (bytes.size() - at < chunk_header_bytes ||
        word_at(bytes, at) > bytes.size() - at - chunk_header_bytes) {
      fail(fmt::format("truncated: the chunk at byte {} goes beyond the end at {}", at, bytes.size()));
    }
    chunk = bytes.substr(at + chunk_header_bytes, word_at(bytes, at));
    at += chunk_header_bytes + chunk.size();
  }
  check_gltf(file, chunks[0], chunks[1]);
}

}  // namespace workbench
