// The hierarchy: rays are traced and questions answered here.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include <kerf/export.hpp>
#include <kerf/query.hpp>
#include <kerf/ray.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// What a build made, and what it cost.
struct BvhStatistics {
  std::size_t triangles = 0;             ///< in the meshes given
  std::size_t degenerate_triangles = 0;  ///< of these, left out because they have no area
  std::size_t references = 0;            ///< triangles in leaves, each counted once per leaf
  std::size_t nodes = 0;                 ///< inner nodes and leaves of the structure that is traced
  std::size_t bytes = 0;                 ///< of the structure that is traced, triangles included
  /// The maximum number of bytes that the build held at once, the finished structure included. What `esc` and
  /// `evh` hold before they build their tree is not included. Never more than `build_memory_bound`.
  std::size_t build_peak_bytes = 0;
  double build_seconds = 0.0;  ///< from the caller's arrays to a structure ready to trace
};

struct KERF_API Structure;  // what a `Bvh` holds: private to the library

/// A split bounding volume hierarchy, ready to trace. A handle: copies share one structure, which never
/// changes, so that any number of threads may make any call at the same time. The floating-point modes of the
/// calling thread do not matter, except that `intersect` and `occluded` of a single ray need a thread that
/// rounds to nearest.
class KERF_API Bvh {
 public:
  /// A hierarchy of nothing, which every ray misses.
  Bvh() noexcept;

  /// Copies share the structure.
  Bvh(const Bvh&) = default;
  /// Copies share the structure.
  Bvh& operator=(const Bvh&) = default;
  /// A handle that was moved from is a hierarchy of nothing.
  Bvh(Bvh&& other) noexcept;
  /// A handle that was moved from is a hierarchy of nothing.
  Bvh& operator=(Bvh&& other) noexcept;
  ~Bvh() = default;

  /// The closest hit in `[ray.t_min, ray.t_max]`. Of several at the same t, the lowest mesh and triangle. t
  /// is within one unit in the last place of the exact crossing, its sign exact; every call gives the same t,
  /// u and v for a ray and a triangle (docs/algorithms.md).
  std::optional<Hit> intersect(const Ray& ray) const;

  /// True if anything is hit in `[ray.t_min, ray.t_max]`.
  bool occluded(const Ray& ray) const;

  /// `hits[i]` becomes the closest hit of `rays[i]`, or a `Hit` that converts to false. Runs on all cores.
  /// The hits are the same as one by one. Throws `Error::invalid_argument` if the spans differ in length.
  void intersect(std::span<const Ray> rays, std::span<Hit> hits) const;

  /// `occluded[i]` becomes 1 if `rays[i]` hits anything, else 0. As above.
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> occluded) const;

  /// Calls `visit(hit)` for every triangle that the ray crosses in `[ray.t_min, ray.t_max]`, each exactly
  /// once, in the order of (t, mesh, primitive), until `visit` returns false; it may also return nothing.
  /// Both sides count.
  ///
  /// Crossings are decided in exact arithmetic, without a tolerance. A ray through an edge or a vertex counts
  /// as moved aside infinitesimally, in the same way for all triangles, so that the line of a ray always
  /// crosses a closed surface an even number of times. A ray that only touches a triangle, or lies in its
  /// plane, does not cross it. Throws `Error::out_of_memory`, and what `visit` throws.
  template <class Visit>
  requires std::invocable<Visit&, const Hit&>
  void all_hits(const Ray& ray, Visit&& visit) const {
    const auto call = [&visit](const Hit& hit) {
      if constexpr (std::is_void_v<std::invoke_result_t<Visit&, const Hit&>>) {
        std::invoke(visit, hit);
        return true;
      } else {
        return static_cast<bool>(std::invoke(visit, hit));
      }
    };
    visit_hits(ray, &call, [](const void* visitor, const Hit& hit) {
      return (*static_cast<decltype(&call)>(visitor))(hit);
    });
  }

  /// The same into the caller's memory: fills `hits` with the first hits and returns the number of all, which
  /// may be more than fit.
  std::size_t all_hits(const Ray& ray, std::span<Hit> hits) const;

  /// Whether `point` lies inside the closed surface that the triangles make, or on it. Decided exactly, by
  /// the parity of the crossings of one ray. For a surface with holes or overlaps, the answer is just that
  /// parity.
  bool contains(const Vec3f& point) const;

  /// The closest point of any triangle within `max_distance` (included); nothing if there is none. Of several
  /// at the same distance, the lowest mesh and triangle. Distances are computed in double precision. The
  /// distance of a point on a triangle may be as large as the rounding of its coordinates instead of 0, and a
  /// limit of 0 then excludes the point.
  std::optional<SurfacePoint> closest_point(
      const Vec3f& point, float max_distance = std::numeric_limits<float>::infinity()) const;

  /// The distance to the closest point of a closed surface, negative inside (`contains`). Its sign is exact,
  /// also where the closest point lies on an edge or a vertex. Infinity for an empty hierarchy.
  float signed_distance(const Vec3f& point) const;

  /// The closest point of every triangle that has a point within `radius` (included) of `point`; each
  /// triangle once, nearest first.
  std::vector<SurfacePoint> within(const Vec3f& point, float radius) const;

  /// Every triangle that has a point in `box`, once, in the order of (mesh, primitive). Decided exactly. A
  /// triangle that touches the box counts.
  std::vector<PrimitiveId> triangles_in(const Box3f& box) const;

  /// Writes the hierarchy to a file (docs/file-format.md). The same meshes and options give the same bytes,
  /// whatever the number of threads. The file is written beside `path` and gets its name when it is complete
  /// and on the disk, so that a crash leaves the old file or the new one. The permissions of an old file are
  /// kept and links are followed. What is not a regular file (a directory, a device) is not replaced. Throws
  /// `Error::io` or `out_of_memory`.
  void save(const std::filesystem::path& path) const;

  /// Reads a file that `save` wrote. Everything in it is checked before it is used: a damaged or forged file
  /// is refused with `Error::bad_format`, which says what is wrong. A large file is read on all cores. Also
  /// throws `Error::io` or `out_of_memory`. The statistics about the build itself are 0.
  static Bvh load(const std::filesystem::path& path);

  /// As `load`, but maps the file into memory that all processes that do so share. Nobody may change or
  /// truncate the file meanwhile; `load` has no such condition.
  static Bvh map(const std::filesystem::path& path);

  /// A box around all triangles; empty for an empty hierarchy.
  Box3f bounds() const;

  /// What the build made. Valid as long as this handle or a copy of it.
  const BvhStatistics& statistics() const;

 private:
  friend struct Structure;
  explicit Bvh(std::shared_ptr<const Structure> structure) noexcept;
  void visit_hits(const Ray& ray, const void* visitor, bool (*visit)(const void*, const Hit&)) const;

  std::shared_ptr<const Structure> structure_;
};

}  // namespace kerf
