// Meshes in double precision become meshes of floats around an origin.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <kerf/build.hpp>
#include <kerf/mesh.hpp>

namespace kerf {

/// Copies of meshes in a frame whose origin lies amid them, so that floats tell their vertices apart.
class LocalFrame {
 public:
  /// On all threads of the task arena that this is called in. Throws `Error::index_out_of_range`,
  /// `Error::too_large` and, unless such triangles are to be skipped, `Error::non_finite_vertex`.
  LocalFrame(std::span<const DoubleMesh> meshes, NonFinite non_finite);

  const Vec3d& origin() const { return origin_; }

  /// With the same triangles in the same order. They live as long as this frame.
  std::span<const TriangleMesh> meshes() const { return local_; }

  /// The memory of the copies.
  std::size_t bytes() const;

  /// How many triangles have an area, but none between the rounded vertices.
  std::size_t degenerate_by_rounding() const;

 private:
  struct Copy {
    std::vector<Vec3f> vertices;
    std::vector<std::uint32_t> indices;  // of 64-bit indices only
  };

  std::span<const DoubleMesh> meshes_;
  Vec3d origin_;
  std::vector<Copy> copies_;
  std::vector<TriangleMesh> local_;
};

}  // namespace kerf
