// The bytes that a glTF file consists of: buffers, and the views of them.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "workbench/formats/file_bytes.hpp"
#include "workbench/formats/gltf/document.hpp"

namespace workbench::gltf {

class Buffers {
 public:
  /// `binary_chunk` is that of a .glb file, which its first buffer is.
  Buffers(const Document& document, std::optional<std::string_view> binary_chunk)
      : document_(document),
        binary_chunk_(binary_chunk),
        buffers_(document.count("buffers")),
        views_(document.count("bufferViews")) {}

  struct View {
    std::string_view bytes;
    std::uint64_t stride = 0;  ///< bytes from one element to the next; 0 if they lie one behind another
  };

  /// The view of that number, unpacked if it is packed. It stays where it is as long as this object.
  View view(std::uint64_t number, std::string_view by);

  /// How many views were unpacked so far, as EXT_meshopt_compression says.
  std::size_t unpacked_views() const { return unpacked_views_; }

  /// Bytes that the file has in all, as far as they were needed so far.
  std::uint64_t total_bytes() const { return total_bytes_; }

 private:
  struct Buffer {
    bool is_read = false;
    std::string_view bytes;
    std::unique_ptr<FileBytes> file;
    std::string decoded;
  };

  std::string_view buffer(std::uint64_t number, std::string_view by);
  void read(Buffer& buffer, const Object& object, std::uint64_t number);
  std::string decode_data_uri(const Object& object, std::string_view uri) const;
  std::string_view part(const Object& view);
  View unpack(const Object& view, const Object& extension);

  const Document& document_;
  std::optional<std::string_view> binary_chunk_;
  std::vector<Buffer> buffers_;
  std::vector<std::optional<View>> views_;
  std::deque<std::string> unpacked_;
  std::size_t unpacked_views_ = 0;
  std::uint64_t total_bytes_ = 0;
};

}  // namespace workbench::gltf
