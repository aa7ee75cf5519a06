// Vertices at the same position become one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <kerf/vec.hpp>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Numbers positions in the order in which they first come. Two are the same if their three coordinates have
/// the same bits.
class VertexJoiner {
 public:
  VertexJoiner();

  /// The number of each position.
  void add(std::span<const kerf::Vec3f> positions, std::uint32_t* numbers);

  /// Each position once. The joiner is empty afterwards.
  std::vector<kerf::Vec3f> take_vertices();

 private:
  struct Slot {
    std::uint32_t tag;     ///< other bits of the hash than those that choose the slot
    std::uint32_t vertex;  ///< or `none`
  };
  std::uint32_t add(const kerf::Vec3f& position, std::uint64_t hash);
  void grow();

  std::vector<Slot> table_;  ///< open addressing; at most half full
  std::vector<kerf::Vec3f> vertices_;
};

/// Joins the vertices that triangles use, in the order of their first use, and drops the others.
void join_vertices(Scene& scene);

}  // namespace workbench
