// Where a finished subtree is kept until the tree is assembled.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>

#include "construction/sbvh/subtree.hpp"
#include "tree/binary_tree.hpp"
#include "tree/reference.hpp"

namespace kerf {

/// Nodes and then references. They overwrite the references that they were built from; what does not fit
/// there has memory of its own.
///
///     in the arena    | node | node | node | node |        one per place
///     spilled         | node | node | references |
class FinishedSubtree {
  static_assert(sizeof(BinaryNode) == sizeof(Reference), "a node is never cut");

 public:
  FinishedSubtree() = default;
  FinishedSubtree(const SubtreeSize& size, const BinaryNode* nodes, const std::uint32_t* references,
                  Reference* places, std::size_t capacity) {
    const std::size_t node_bytes = size.nodes * sizeof(BinaryNode);
    const std::size_t bytes = node_bytes + size.references * sizeof(std::uint32_t);
    places_ = reinterpret_cast<std::byte*>(places);
    here_ = std::min(bytes, capacity * sizeof(Reference));
    spilled_ = bytes - here_;
    if (spilled_ != 0) spill_.reset(new std::byte[spilled_]);
    write(0, nodes, node_bytes);
    write(node_bytes, references, bytes - node_bytes);
  }

  std::size_t spilled_bytes() const { return spilled_; }

  void read_node(std::uint32_t i, BinaryNode& node) const {
    const std::size_t at = i * sizeof(BinaryNode);
    std::memcpy(&node, at < here_ ? places_ + at : spill_.get() + (at - here_), sizeof node);
  }

  void read_references(const SubtreeSize& size, std::uint32_t* to) const {
    const std::size_t begin = size.nodes * sizeof(BinaryNode);
    const std::size_t bytes = size.references * sizeof(std::uint32_t), here = part_here(begin, bytes);
    std::memcpy(to, places_ + std::min(begin, here_), here);
    if (bytes > here) {
      std::memcpy(reinterpret_cast<std::byte*>(to) + here, spill_.get() + (begin + here - here_),
                  bytes - here);
    }
  }

 private:
  // How many of the bytes from `begin` on stand in the arena.
  std::size_t part_here(std::size_t begin, std::size_t bytes) const {
    return begin < here_ ? std::min(bytes, here_ - begin) : 0;
  }

  void write(std::size_t begin, const void* from, std::size_t bytes) {
    const std::size_t here = part_here(begin, bytes);
    std::memcpy(places_ + std::min(begin, here_), from, here);
    if (bytes > here) {
      std::memcpy(spill_.get() + (begin + here - here_), static_cast<const std::byte*>(from) + here,
                  bytes - here);
    }
  }

  std::byte* places_ = nullptr;
  std::size_t here_ = 0, spilled_ = 0;
  std::unique_ptr<std::byte[]> spill_;
};

}  // namespace kerf
