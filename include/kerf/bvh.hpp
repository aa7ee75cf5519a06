// The hierarchy: rays are traced and questions answered here.
#pragma once

#include <kerf/cpp20.hpp>
#ifdef KERF_HAS_CPP20

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include <kerf/batch.hpp>
#include <kerf/export.hpp>
#include <kerf/file_name.hpp>
#include <kerf/query.hpp>
#include <kerf/ray.hpp>
#include <kerf/shared.hpp>
#include <kerf/vec.hpp>

namespace kerf {

/// What a build made, and what it cost.
struct BvhStatistics {
  std::size_t triangles = 0;             ///< in the meshes given
  std::size_t degenerate_triangles = 0;  ///< of these, left out because they have no area
  std::size_t non_finite_triangles = 0;  ///< left out by `NonFinite::skip`
  /// Of the degenerate triangles, those that have an area in the doubles of their `DoubleMesh`.
  std::size_t degenerate_by_rounding = 0;
  std::size_t references = 0;  ///< triangles in leaves, each counted once per leaf
  std::size_t nodes = 0;       ///< inner nodes and leaves of the structure that is traced
  std::size_t bytes = 0;       ///< of the structure that is traced, triangles included
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

  /// The same, written where the caller keeps hits: true and the closest hit, or false and a `Hit` that
  /// converts to false, as calls for many rays write it.
  bool intersect(const Ray& ray, Hit& hit) const;

  /// True if anything is hit in `[ray.t_min, ray.t_max]`.
  bool occluded(const Ray& ray) const;

  /// Hit i becomes the closest hit of ray i, or a `Hit` that converts to false. The hits are the same as one
  /// by one. This and all calls below that take many rays, points or boxes run on all cores, or on as many
  /// threads as `options` says. They throw `Error::invalid_argument` if what is given differs in length, and
  /// `Error::out_of_memory`.
  void intersect(const RayView& rays, const HitView& hits, const BatchOptions& options = {}) const;

  /// Flag i becomes 1 if ray i hits anything, else 0.
  void occluded(const RayView& rays, const FlagView& occluded, const BatchOptions& options = {}) const;

  /// The closest of the hits that `filter` accepts: transparency by a texture, everything but one triangle,
  /// front faces only. `filter(hit)` is asked about hits that are nearer than all that it has accepted, in
  /// any order, about each triangle at most once. What it throws is passed on.
  template <class Filter>
  requires std::predicate<Filter&, const Hit&> std::optional<Hit> intersect(const Ray& ray, Filter&& filter)
  const { return intersect(ray, Mask(), filter); }

  /// True if anything is hit that `filter` accepts. It is asked until it accepts a hit, as above.
  template <class Filter>
  requires std::predicate<Filter&, const Hit&>
  bool occluded(const Ray& ray, Filter&& filter) const { return occluded(ray, Mask(), filter); }

  /// The closest hit of a mesh that the ray sees.
  std::optional<Hit> intersect(const Ray& ray, Mask mask) const {
    return intersect_filtered(ray, mask, nullptr, nullptr);
  }

  /// True if a mesh is hit that the ray sees.
  bool occluded(const Ray& ray, Mask mask) const { return occluded_filtered(ray, mask, nullptr, nullptr); }

  /// The closest of the hits of meshes that the ray sees which `filter` accepts.
  template <class Filter>
  requires std::predicate<Filter&, const Hit&> std::optional<Hit> intersect(const Ray& ray, Mask mask,
                                                                            Filter&& filter)
  const {
    auto call = [&filter](const Hit& hit) { return static_cast<bool>(std::invoke(filter, hit)); };
    return intersect_filtered(ray, mask, &call, call_filter<decltype(call)>);
  }

  /// True if a mesh that the ray sees is hit and `filter` accepts the hit.
  template <class Filter>
  requires std::predicate<Filter&, const Hit&>
  bool occluded(const Ray& ray, Mask mask, Filter&& filter) const {
    auto call = [&filter](const Hit& hit) { return static_cast<bool>(std::invoke(filter, hit)); };
    return occluded_filtered(ray, mask, &call, call_filter<decltype(call)>);
  }

  /// Hit i becomes the closest of the hits that `filter(i, hit)` accepts for ray i. `filter` is called from
  /// all threads at once; what it throws is passed on.
  template <class Filter>
  requires std::predicate<const Filter&, std::size_t, const Hit&>
  void intersect(const RayView& rays, const HitView& hits, const Filter& filter,
                 const BatchOptions& options = {}) const {
    intersect_filtered(rays, hits, options, &filter, call_filter_of_many<Filter>);
  }

  /// Flag i becomes 1 if ray i hits anything that `filter(i, hit)` accepts, else 0. As above.
  template <class Filter>
  requires std::predicate<const Filter&, std::size_t, const Hit&>
  void occluded(const RayView& rays, const FlagView& occluded, const Filter& filter,
                const BatchOptions& options = {}) const {
    occluded_filtered(rays, occluded, options, &filter, call_filter_of_many<Filter>);
  }

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

  /// The number of hits that `all_hits` visits, found without their order and place: in half the time. Throws
  /// `Error::out_of_memory`.
  std::size_t count_hits(const Ray& ray) const;

  /// The same for many rays.
  void count_hits(const RayView& rays, std::span<std::uint32_t> counts,
                  const BatchOptions& options = {}) const;

  /// All hits of each of many rays, those of a ray in their order.
  Lists<Hit> all_hits(const RayView& rays, const BatchOptions& options = {}) const;

  /// The same into the caller's memory: those of ray i to `hits[offsets[i]]` and on, up to `offsets[i + 1]`.
  /// There is one more offset than rays. Of hits for which there is no room, the first are kept; room that is
  /// left is filled with a `Hit` that converts to false. Sums of what `count_hits` gives are offsets that
  /// fit.
  void all_hits(const RayView& rays, std::span<const std::size_t> offsets, std::span<Hit> hits,
                const BatchOptions& options = {}) const;

  /// Whether `point` lies inside the closed surface that the triangles make, or on it. Decided exactly, by
  /// the parity of the crossings of one ray. For a surface with holes or overlaps, the answer is just that
  /// parity.
  bool contains(const Vec3f& point) const;

  /// The same for many points.
  void contains(const PointView& points, const FlagView& inside, const BatchOptions& options = {}) const;

  /// As `contains`, with the surface told from the inside.
  Side side(const Vec3f& point) const;

  /// The same for many points.
  void side(const PointView& points, std::span<Side> sides, const BatchOptions& options = {}) const;

  /// The closest point of any triangle within `max_distance` (included); nothing if there is none. Of several
  /// at the same distance, the lowest mesh and triangle. Distances are computed in double precision. The
  /// distance of a point on a triangle may be as large as the rounding of its coordinates instead of 0, and a
  /// limit of 0 then excludes the point.
  std::optional<SurfacePoint> closest_point(
      const Vec3f& point, float max_distance = std::numeric_limits<float>::infinity()) const;

  /// The same for many points. Where there is none, the result converts to false.
  void closest_point(const PointView& points, std::span<SurfacePoint> closest,
                     float max_distance = std::numeric_limits<float>::infinity(),
                     const BatchOptions& options = {}) const;

  /// The closest points of the `count` triangles that are nearest to `point`, nearest first, or of fewer if
  /// not so many lie within `max_distance` (included). Each triangle once; of several at the same distance
  /// the lowest mesh and triangle first.
  std::vector<SurfacePoint> nearest(const Vec3f& point, std::size_t count,
                                    float max_distance = std::numeric_limits<float>::infinity()) const;

  /// The same for many points.
  Lists<SurfacePoint> nearest(const PointView& points, std::size_t count,
                              float max_distance = std::numeric_limits<float>::infinity(),
                              const BatchOptions& options = {}) const;

  /// The distance to the closest point of a closed surface, negative inside (`contains`). Its sign is exact,
  /// also where the closest point lies on an edge or a vertex. Infinity for an empty hierarchy.
  float signed_distance(const Vec3f& point) const;

  /// The same for many points.
  void signed_distance(const PointView& points, std::span<float> distances,
                       const BatchOptions& options = {}) const;

  /// The closest point of every triangle that has a point within `radius` (included) of `point`; each
  /// triangle once, nearest first.
  std::vector<SurfacePoint> within(const Vec3f& point, float radius) const;

  /// The same for many points.
  Lists<SurfacePoint> within(const PointView& points, float radius, const BatchOptions& options = {}) const;

  /// Every triangle that has a point in `box`, once, in the order of (mesh, primitive). Decided exactly. A
  /// triangle that touches the box counts.
  std::vector<PrimitiveId> triangles_in(const Box3f& box) const;

  /// The same for many boxes.
  Lists<PrimitiveId> triangles_in(std::span<const Box3f> boxes, const BatchOptions& options = {}) const;

  /// Whether a triangle of this hierarchy and a triangle of `other`, moved by `transform`, have a point in
  /// common. Stops at the first pair that is found; see `touching_pairs`.
  bool touches(const Bvh& other, const Transform& transform = {}) const;

  /// All pairs of a triangle of this hierarchy and a triangle of `other`, moved by `transform`, that have a
  /// point in common; touching counts. Each pair once, in the order of (mesh, primitive) of the first, then
  /// of the second.
  ///
  /// The vertices of `other` are moved first, in double precision, and rounded to floats, each once: a vertex
  /// that triangles share stays shared. For the triangles as they are then, the answer is exact. A triangle
  /// that is flattened by this to a line or a point counts as that. Throws `Error::invalid_argument` if a
  /// number of the transform is not finite or a moved vertex has a coordinate of 2^126 or more, and
  /// `Error::out_of_memory`.
  std::vector<TouchingPair> touching_pairs(const Bvh& other, const Transform& transform = {},
                                           const BatchOptions& options = {}) const;

  /// A triangle by its corners, as they were given to `build`; nothing if it is in no leaf, because it has no
  /// area, or does not exist. The first call goes over all leaves once, to keep 4 bytes per triangle from
  /// then on. Throws `Error::out_of_memory`.
  std::optional<Triangle> triangle(const PrimitiveId& id) const;

  /// What `ray` meets at `hit`, which a call of this hierarchy gave for it. Which side the ray comes from is
  /// exact. Throws `Error::invalid_argument` for a hit of no triangle; as `triangle` otherwise.
  HitGeometry geometry(const Ray& ray, const Hit& hit) const;

  /// What the hierarchy has of each mesh, in the order given to `build`. Goes over all leaves. Throws
  /// `Error::out_of_memory`.
  std::vector<MeshStatistics> mesh_statistics() const;

  /// Writes the hierarchy to a file (docs/file-format.md). The same meshes and options give the same bytes,
  /// whatever the number of threads, on all machines whose nodes have as many children (`Layout::width`).
  /// The file is written beside `name` and gets its name when it is complete and on the disk, so that a crash
  /// leaves the old file or the new one. The permissions of an old file are kept and links are followed. What
  /// is not a regular file (a directory, a device) is not replaced. Throws `Error::io` or `out_of_memory`.
  void save(const FileName& name) const;

  /// The bytes of that file. Throws `Error::out_of_memory`.
  std::vector<std::byte> save() const;

  /// Reads a file that `save` wrote. Nodes of another width than this machine traces are converted.
  /// Everything in it is checked before it is used: a damaged or forged file is refused with
  /// `Error::bad_format`, which says what is wrong. A large file is read on all cores. Also throws
  /// `Error::io` or `out_of_memory`. The statistics about the build itself are 0.
  static Bvh load(const FileName& name);

  /// The same from the bytes of such a file, which are copied. Throws `Error::bad_format` or `out_of_memory`.
  static Bvh load(std::span<const std::byte> bytes);

  /// As `load`, but refuses nodes of another width with `Error::bad_format`, and maps the file into memory
  /// that all processes that do so share. Nobody may change or truncate the file meanwhile; `load` has no
  /// such condition.
  static Bvh map(const FileName& name);

  /// Where the local frame lies in which the hierarchy was built: 0 unless it was built from a `DoubleMesh`.
  /// All rays, points and boxes of the other calls are distances from it.
  Vec3d origin() const;

  /// A place in the coordinates of the meshes as all calls take it: its distance from `origin()`, rounded.
  Vec3f to_local(const Vec3d& point) const;

  /// A ray in the coordinates of the meshes as all calls take it. t counts in lengths of the same direction.
  Ray to_local(const DoubleRay& ray) const;

  /// A point that a call has returned, in the coordinates of the meshes.
  Vec3d from_local(const Vec3f& point) const;

  /// A box around all triangles; empty for an empty hierarchy.
  Box3f bounds() const;

  /// Equal for copies of one handle, which share a structure, and for no others that exist at the same time:
  /// says which instances of a scene are of one object.
  const void* identity() const { return structure_.get(); }

  /// What the build made. Valid as long as this handle or a copy of it.
  const BvhStatistics& statistics() const;

 private:
  friend struct Structure;
  explicit Bvh(Shared<Structure> structure) noexcept;
  template <class Call>
  static bool call_filter(void* call, const Hit& hit) {
    return (*static_cast<Call*>(call))(hit);
  }
  template <class Filter>
  static bool call_filter_of_many(const void* filter, std::size_t ray, const Hit& hit) {
    return static_cast<bool>((*static_cast<const Filter*>(filter))(ray, hit));
  }
  using FilterOfMany = bool (*)(const void* context, std::size_t ray, const Hit& hit);
  void intersect_filtered(const RayView& rays, const HitView& hits, const BatchOptions& options,
                          const void* context, FilterOfMany accept) const;
  void occluded_filtered(const RayView& rays, const FlagView& occluded, const BatchOptions& options,
                         const void* context, FilterOfMany accept) const;
  std::optional<Hit> intersect_filtered(const Ray& ray, Mask mask, void* context,
                                        bool (*accept)(void* context, const Hit& hit)) const;
  bool occluded_filtered(const Ray& ray, Mask mask, void* context,
                         bool (*accept)(void* context, const Hit& hit)) const;
  void visit_hits(const Ray& ray, const void* visitor, bool (*visit)(const void*, const Hit&)) const;

  Shared<Structure> structure_;
};

}  // namespace kerf

#endif  // KERF_HAS_CPP20
