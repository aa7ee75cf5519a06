// Hierarchies in the memory of a GPU: rays are traced and questions answered there, bit for bit as on the
// CPU.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include <kerf/bvh.hpp>
#include <kerf/cuda/error.hpp>
#include <kerf/inspect.hpp>
#include <kerf/mesh.hpp>
#include <kerf/query.hpp>
#include <kerf/ray.hpp>

struct CUstream_st;

namespace kerf::cuda {

/// A stream of the CUDA runtime: `cudaStream_t`. Null is the default stream.
using Stream = CUstream_st*;

/// How to build on the device.
struct BuildOptions {
  /// At most this many references a triangle; the memory for them is taken before the build begins. 1 leaves
  /// no room for splits. Range: [1, 16].
  float max_reference_ratio = 1.5f;

  /// At most this many references in a leaf. Range: [1, 8].
  std::uint32_t max_leaf_size = 8;

  /// How many neighbours to either side are looked at before two clusters merge. Range: [1, 64].
  std::uint32_t radius = 8;
};

struct BvhStatistics {
  std::size_t triangles = 0;             ///< in the meshes given
  std::size_t degenerate_triangles = 0;  ///< of these, left out because they have no area; 0 for uploads
  std::size_t references = 0;            ///< triangles in leaves, counted as often as they stand there
  std::size_t nodes = 0;                 ///< of two children each
  std::size_t bytes = 0;                 ///< of the device's memory
  std::size_t scratch_bytes = 0;         ///< that the build held besides; 0 for uploads
  double cost = 0.0;  ///< of the surface area heuristic, as `surface_area_cost`; 0 for uploads
};

/// A binary hierarchy in the memory of the device that is current when it is made. A handle: copies share one
/// structure.
///
/// Queries read and write memory of that device: arrays of `count` elements that stay the caller's, from
/// CuPy, PyTorch or `cudaMalloc`. They only start kernels on `stream`: they wait for nothing, allocate
/// nothing and may be captured into a graph. Each gives bit for bit what the same call of `kerf::Bvh` gives,
/// whichever way the hierarchy was made. Any number of threads and streams may query at once. All calls throw
/// `Error` where CUDA reports one.
class Bvh {
 public:
  /// A hierarchy of nothing, which every ray misses.
  Bvh() noexcept = default;

  /// The hierarchy of `bvh`, copied. Waits until it is there.
  explicit Bvh(const kerf::Bvh& bvh);

  /// The tree that a builder of the library made, which rays pass somewhat faster than the binary tree that
  /// can be read off a `kerf::Bvh`. Leaves must have no more than 8 references.
  explicit Bvh(const kerf::Tree& tree);

  /// Builds on the device: splits of large triangles, then merging of neighbours. The meshes' vertices and
  /// triangles are memory of the device. Waits until it is done. Throws `Error` for options out of range,
  /// indices out of range, vertices that are not finite, and where there is too little memory; what it takes
  /// is known before, see `build_bytes`.
  static Bvh build(std::span<const TriangleMesh> meshes, const BuildOptions& options = {},
                   Stream stream = nullptr);

  /// `hits[i]` becomes the closest hit of `rays[i]`, or a `Hit` that converts to false.
  void intersect(const Ray* rays, Hit* hits, std::size_t count, Stream stream = nullptr) const;

  /// `occluded[i]` becomes 1 if `rays[i]` hits anything, else 0.
  void occluded(const Ray* rays, std::uint8_t* occluded, std::size_t count, Stream stream = nullptr) const;

  /// `counts[i]` becomes the number of triangles that `rays[i]` crosses, decided exactly as
  /// `kerf::Bvh::all_hits` does it.
  void count_hits(const Ray* rays, std::uint32_t* counts, std::size_t count, Stream stream = nullptr) const;

  /// The first `offsets[i + 1] - offsets[i]` of these crossings, in the order of (t, mesh, primitive), from
  /// `hits[offsets[i]]` on; behind the last one, where there is room, `Hit`s that convert to false. `offsets`
  /// has `count + 1` elements: the sums of `count_hits` before each ray, or multiples of as many hits as are
  /// wanted.
  void list_hits(const Ray* rays, const std::uint64_t* offsets, Hit* hits, std::size_t count,
                 Stream stream = nullptr) const;

  /// `inside[i]` becomes 1 if `points[i]` lies inside the closed surface that the triangles make, or on it,
  /// else 0; decided exactly.
  void contains(const Vec3f* points, std::uint8_t* inside, std::size_t count, Stream stream = nullptr) const;

  /// `closest[i]` becomes the closest point of any triangle within `max_distance` of `points[i]`; where there
  /// is none, its `primitive` is `invalid_id`.
  void closest_point(const Vec3f* points, SurfacePoint* closest, std::size_t count,
                     float max_distance = std::numeric_limits<float>::infinity(),
                     Stream stream = nullptr) const;

  /// `distances[i]` becomes the distance of `points[i]` to a closed surface, negative inside; infinity in a
  /// hierarchy of nothing.
  void signed_distance(const Vec3f* points, float* distances, std::size_t count,
                       Stream stream = nullptr) const;

  /// Moves the hierarchy to where the meshes' vertices are now, in place for all that share it: the same
  /// meshes, with as many triangles. Starts kernels on `stream`; queries there see the moved hierarchy.
  /// Triangles that were left out because they had no area stay out. A triangle in several leaves takes all
  /// of its box in each of them: every answer is still exact, but where many triangles were split, a new
  /// build is faster to trace. Vertices that are not finite or indices out of range are taken as they come
  /// for corners at the origin. Not for `Bvh`s made of `kerf::Bvh`s whose meshes are not the caller's.
  void refit(std::span<const TriangleMesh> meshes, Stream stream = nullptr);

  /// A box around all triangles; empty for a hierarchy of nothing. Waits for the device after `refit`.
  Box3f bounds() const;

  const BvhStatistics& statistics() const;

  struct Content;  ///< private to the face
  const Content* content() const { return content_.get(); }

 private:
  explicit Bvh(std::shared_ptr<Content> content) : content_(std::move(content)) {}

  std::shared_ptr<Content> content_;
};

/// The most bytes of the device's memory that `Bvh::build` of so many triangles holds at once.
std::size_t build_bytes(std::size_t triangles, const BuildOptions& options = {});

}  // namespace kerf::cuda
