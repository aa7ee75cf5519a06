#include "files/file_header.hpp"
#include "layout/wide_bvh.hpp"

namespace kerf {
namespace {

std::uint64_t aligned(std::uint64_t offset) {
  return (offset + FileLayout::alignment - 1) / FileLayout::alignment * FileLayout::alignment;
}

}  // namespace

FileLayout::FileLayout(const FileHeader& header)
    : meshes_at(aligned(sizeof(FileHeader))),
      meshes_bytes((std::uint64_t{header.meshes} + 1) * sizeof(std::uint32_t)),
      nodes_at(aligned(meshes_at + meshes_bytes)),
      nodes_bytes(std::uint64_t{header.nodes} * sizeof(WideNode)),
      leaves_at(aligned(nodes_at + nodes_bytes)),
      leaves_bytes(header.leaf_words * sizeof(std::uint32_t)),
      file_bytes(aligned(leaves_at + leaves_bytes)) {}

}  // namespace kerf
