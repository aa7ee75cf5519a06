// The file of a hierarchy, in pieces that lie where the hierarchy has them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "files/file_header.hpp"
#include "structure.hpp"

namespace kerf {

/// The pieces, one behind the other, are the file. They live as long as this and the structure.
class FileImage {
 public:
  explicit FileImage(const Structure& structure);
  FileImage(const FileImage&) = delete;
  FileImage& operator=(const FileImage&) = delete;

  std::span<const std::span<const std::byte>> pieces() const { return pieces_; }
  /// Of all pieces, a multiple of 64.
  std::uint64_t bytes() const { return header_.file_bytes; }

 private:
  FileHeader header_;
  FileAnnex annex_;
  std::array<std::span<const std::byte>, 12> pieces_;
};

/// Pieces of `bytes` bytes as one. Throws `std::bad_alloc`.
std::vector<std::byte> joined(std::span<const std::span<const std::byte>> pieces, std::uint64_t bytes);

/// `count` zeros, no more than 64.
std::span<const std::byte> zeros(std::uint64_t count);

}  // namespace kerf
