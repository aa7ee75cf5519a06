// The hierarchy: rays are traced and questions answered here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <kerf/ray.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// What a build made, and what it took.
struct BvhStatistics {
  std::size_t triangles = 0;             ///< in the meshes given
  std::size_t degenerate_triangles = 0;  ///< of these, left out because they have no area
  std::size_t references = 0;            ///< triangles in leaves, counted as often as they stand there
  std::size_t nodes = 0;                 ///< inner nodes and leaves of the structure that is traced
  std::size_t bytes = 0;                 ///< of the structure that is traced, triangles included
  std::size_t build_peak_bytes = 0;      ///< the most memory that the build held at once, the result included
  double build_seconds = 0.0;            ///< from the caller's arrays to a structure ready to trace
};

/// A split bounding volume hierarchy, ready to trace. A handle: copies share one structure, which never changes,
/// so every call may be made from any number of threads at once.
class Bvh {
 public:
  /// A hierarchy of nothing, which every ray misses.
  Bvh();

  /// The closest hit in `[ray.t_min, ray.t_max]`. Of several at the same t, the lowest mesh and triangle.
  std::optional<Hit> intersect(const Ray& ray) const;

  /// True if anything is hit in `[ray.t_min, ray.t_max]`.
  bool occluded(const Ray& ray) const;

  /// `hits[i]` becomes the closest hit of `rays[i]`, or a `Hit` that converts to false. All cores; the same hits
  /// as one by one. Throws `Error::invalid_argument` if the spans differ in length.
  void intersect(std::span<const Ray> rays, std::span<Hit> hits) const;

  /// `occluded[i]` becomes 1 if `rays[i]` hits anything, else 0. As above.
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> occluded) const;

  /// A box around all triangles; empty for an empty hierarchy.
  Box3f bounds() const;

  const BvhStatistics& statistics() const;

  struct Structure;  // what the kernels trace: private to the library
  explicit Bvh(std::shared_ptr<const Structure> structure);
  const Structure& structure() const { return *structure_; }

 private:
  std::shared_ptr<const Structure> structure_;
};

}  // namespace kerf
