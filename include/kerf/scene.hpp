// Scenes of objects that repeat and move: many places for one hierarchy.
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
#include <kerf/build.hpp>
#include <kerf/bvh.hpp>
#include <kerf/export.hpp>
#include <kerf/file_name.hpp>
#include <kerf/query.hpp>
#include <kerf/ray.hpp>
#include <kerf/triangle.hpp>
#include <kerf/vec.hpp>

namespace kerf {

struct Instance;

/// Where a ray crosses a triangle of an instance. As `Hit`, and
struct SceneHit {
  float t = std::numeric_limits<float>::infinity();  ///< in lengths of the ray's direction
  float u = 0.0f;                                    ///< weight of v1
  float v = 0.0f;                                    ///< weight of v2
  std::uint32_t primitive = invalid_id;              ///< number of the triangle within its mesh
  std::uint32_t mesh = invalid_id;                   ///< number of the mesh within the object
  std::uint32_t instance = invalid_id;               ///< number of the instance, see `Scene::path`

  /// True for a hit, false for the value that the span calls write for a miss.
  constexpr explicit operator bool() const { return instance != invalid_id; }

  friend constexpr bool operator==(const SceneHit&, const SceneHit&) = default;
};

/// The point of a triangle of an instance that is closest to a given point. As `SurfacePoint`, and
struct ScenePoint {
  Vec3f position;                                           ///< the point itself, in the scene
  float distance = std::numeric_limits<float>::infinity();  ///< from the given point, in the scene
  float u = 0.0f;                                           ///< weight of v1
  float v = 0.0f;                                           ///< weight of v2
  std::uint32_t primitive = invalid_id;                     ///< number of the triangle within its mesh
  std::uint32_t mesh = invalid_id;                          ///< number of the mesh within the object
  std::uint32_t instance = invalid_id;                      ///< number of the instance, see `Scene::path`

  /// True for a point, false for the value that calls for many points write where there is none.
  constexpr explicit operator bool() const { return instance != invalid_id; }

  friend constexpr bool operator==(const ScenePoint&, const ScenePoint&) = default;
};

/// A triangle of an instance. As `PrimitiveId`, and
struct ScenePrimitiveId {
  std::uint32_t primitive = invalid_id;  ///< number of the triangle within its mesh
  std::uint32_t mesh = invalid_id;       ///< number of the mesh within the object
  std::uint32_t instance = invalid_id;   ///< number of the instance, see `Scene::path`

  friend constexpr bool operator==(const ScenePrimitiveId&, const ScenePrimitiveId&) = default;
};

/// Two triangles of instances that have a point in common.
struct SceneTouchingPair {
  ScenePrimitiveId first;   ///< of the scene that was asked
  ScenePrimitiveId second;  ///< of the other

  friend constexpr bool operator==(const SceneTouchingPair&, const SceneTouchingPair&) = default;
};

struct KERF_API SceneStructure;  // what a `Scene` holds: private to the library

/// A hierarchy over instances. A handle: copies share one structure, which never changes, so that any number
/// of threads may make any call at the same time.
///
/// A ray is taken to an object's space once, in double precision; its origin and its direction are then
/// rounded to floats, each component once. For all triangles of the object it is the same ray, so that an
/// instance is as watertight as its object; t, u and v are those that the object's own calls give for that
/// ray. The rounding moves a ray, along each axis of the scene, by at most
///
///     2^-24 (2 K D + 2 S)
///
/// with D the largest distance along an axis from the ray's origin to the far side of the object, S the
/// largest coordinate of the object's box, measured in the scene, and K the condition of the transform, which
/// is 1 where axes go to axes and at most 3 for a turn (docs/algorithms.md). A ray that meets an edge within
/// this may hit the other triangle of the edge than in a mesh of all instances. The same is true of points.
/// Where scenes stand in scenes, each level rounds so, and what it moves is moved on by those above it.
class KERF_API Scene {
 public:
  /// A scene of nothing, which every ray misses.
  Scene() noexcept;

  /// Copies share the structure.
  Scene(const Scene&) = default;
  /// Copies share the structure.
  Scene& operator=(const Scene&) = default;
  /// A handle that was moved from is a scene of nothing.
  Scene(Scene&& other) noexcept;
  /// A handle that was moved from is a scene of nothing.
  Scene& operator=(Scene&& other) noexcept;
  ~Scene() = default;

  /// The closest hit in `[ray.t_min, ray.t_max]`. Of several at the same t, the lowest instance, mesh and
  /// triangle.
  std::optional<SceneHit> intersect(const Ray& ray) const;

  /// True if anything is hit in `[ray.t_min, ray.t_max]`.
  bool occluded(const Ray& ray) const;

  /// The closest hit of an instance and a mesh which the ray sees both, and with it all scenes around them.
  std::optional<SceneHit> intersect(const Ray& ray, Mask mask) const {
    return intersect_filtered(ray, mask, nullptr, nullptr);
  }

  /// True if a mesh is hit which the ray sees, of an instance that it sees.
  bool occluded(const Ray& ray, Mask mask) const { return occluded_filtered(ray, mask, nullptr, nullptr); }

  /// The closest of the hits that `filter` accepts. `filter(hit)` is asked about hits that are nearer than
  /// all that it has accepted, in any order, about each triangle of each instance at most once. What it
  /// throws is passed on.
  template <class Filter>
  requires std::predicate<Filter&, const SceneHit&> std::optional<SceneHit> intersect(const Ray& ray,
                                                                                      Filter&& filter)
  const { return intersect(ray, Mask(), filter); }

  /// True if anything is hit that `filter` accepts. It is asked until it accepts a hit, as above.
  template <class Filter>
  requires std::predicate<Filter&, const SceneHit&>
  bool occluded(const Ray& ray, Filter&& filter) const { return occluded(ray, Mask(), filter); }

  /// The closest of the hits, of instances and meshes that the ray sees, which `filter` accepts.
  template <class Filter>
  requires std::predicate<Filter&, const SceneHit&> std::optional<SceneHit> intersect(const Ray& ray,
                                                                                      Mask mask,
                                                                                      Filter&& filter)
  const {
    auto call = [&filter](const SceneHit& hit) { return static_cast<bool>(std::invoke(filter, hit)); };
    return intersect_filtered(ray, mask, &call, call_filter<decltype(call)>);
  }

  /// True if a mesh is hit which the ray sees, of an instance that it sees, and `filter` accepts the hit.
  template <class Filter>
  requires std::predicate<Filter&, const SceneHit&>
  bool occluded(const Ray& ray, Mask mask, Filter&& filter) const {
    auto call = [&filter](const SceneHit& hit) { return static_cast<bool>(std::invoke(filter, hit)); };
    return occluded_filtered(ray, mask, &call, call_filter<decltype(call)>);
  }

  /// Hit i becomes the closest hit of ray i, or a `SceneHit` that converts to false. The hits are the same as
  /// one by one. This and all calls below that take many rays or points run on all cores, or on as many
  /// threads as `options` says. They throw `Error::invalid_argument` if what is given differs in length, and
  /// `Error::out_of_memory`.
  void intersect(const RayView& rays, std::span<SceneHit> hits, const BatchOptions& options = {}) const;

  /// Flag i becomes 1 if ray i hits anything, else 0.
  void occluded(const RayView& rays, const FlagView& occluded, const BatchOptions& options = {}) const;

  /// Hit i becomes the closest of the hits that `filter(i, hit)` accepts for ray i. `filter` is called from
  /// all threads at once; what it throws is passed on.
  template <class Filter>
  requires std::predicate<const Filter&, std::size_t, const SceneHit&>
  void intersect(const RayView& rays, std::span<SceneHit> hits, const Filter& filter,
                 const BatchOptions& options = {}) const {
    intersect_filtered(rays, hits, options, &filter, call_filter_of_many<Filter>);
  }

  /// Flag i becomes 1 if ray i hits anything that `filter(i, hit)` accepts, else 0. As above.
  template <class Filter>
  requires std::predicate<const Filter&, std::size_t, const SceneHit&>
  void occluded(const RayView& rays, const FlagView& occluded, const Filter& filter,
                const BatchOptions& options = {}) const {
    occluded_filtered(rays, occluded, options, &filter, call_filter_of_many<Filter>);
  }

  /// Calls `visit(hit)` for every triangle that the ray crosses in `[ray.t_min, ray.t_max]`, each once for
  /// each instance, in the order of (t, instance, mesh, primitive), until `visit` returns false; it may also
  /// return nothing. Decided exactly, as by `Bvh::all_hits`, for the ray as each object sees it. Throws
  /// `Error::out_of_memory`, and what `visit` throws.
  template <class Visit>
  requires std::invocable<Visit&, const SceneHit&>
  void all_hits(const Ray& ray, Visit&& visit) const {
    for (const SceneHit& hit : list_hits(ray)) {
      if constexpr (std::is_void_v<std::invoke_result_t<Visit&, const SceneHit&>>) {
        std::invoke(visit, hit);
      } else if (!std::invoke(visit, hit)) {
        return;
      }
    }
  }

  /// All hits of each of many rays, those of a ray in their order.
  Lists<SceneHit> all_hits(const RayView& rays, const BatchOptions& options = {}) const;

  /// The number of hits that `all_hits` visits. Throws `Error::out_of_memory`.
  std::size_t count_hits(const Ray& ray) const;

  /// The same for many rays.
  void count_hits(const RayView& rays, std::span<std::uint32_t> counts,
                  const BatchOptions& options = {}) const;

  /// Whether `point` lies inside the closed surface that all triangles make, or on it: by the parity of the
  /// crossings of one ray through all instances. It is right to the last crossing where each object is closed
  /// by itself. Where two of them overlap, it is even: outside, as for a mesh of both.
  bool contains(const Vec3f& point) const;

  /// The same for many points.
  void contains(const PointView& points, const FlagView& inside, const BatchOptions& options = {}) const;

  /// As `contains`, with the surface told from the inside: a point is on it where it is on the surface of an
  /// object, in whose space it has been rounded.
  Side side(const Vec3f& point) const;

  /// The same for many points.
  void side(const PointView& points, std::span<Side> sides, const BatchOptions& options = {}) const;

  /// The closest point of any triangle within `max_distance` (included); nothing if there is none. Of several
  /// at the same distance, the lowest instance, mesh and triangle. Distances are those in the scene, also
  /// where transforms scale and shear, computed in double precision from corners that are moved in double
  /// precision.
  std::optional<ScenePoint> closest_point(const Vec3f& point,
                                          float max_distance = std::numeric_limits<float>::infinity()) const;

  /// The same for many points. Where there is none, the result converts to false.
  void closest_point(const PointView& points, std::span<ScenePoint> closest,
                     float max_distance = std::numeric_limits<float>::infinity(),
                     const BatchOptions& options = {}) const;

  /// The closest points of the `count` triangles that are nearest to `point`, nearest first, or of fewer if
  /// not so many lie within `max_distance` (included). Each triangle of each instance once; of several at the
  /// same distance the lowest instance, mesh and triangle first. Distances as by `closest_point`.
  std::vector<ScenePoint> nearest(const Vec3f& point, std::size_t count,
                                  float max_distance = std::numeric_limits<float>::infinity()) const;

  /// The same for many points.
  Lists<ScenePoint> nearest(const PointView& points, std::size_t count,
                            float max_distance = std::numeric_limits<float>::infinity(),
                            const BatchOptions& options = {}) const;

  /// The distance to the closest point of a closed surface, negative inside (`contains`). Infinity for a
  /// scene of nothing.
  float signed_distance(const Vec3f& point) const;

  /// The same for many points.
  void signed_distance(const PointView& points, std::span<float> distances,
                       const BatchOptions& options = {}) const;

  /// The closest point of every triangle that has a point within `radius` (included) of `point`; each
  /// triangle of each instance once, nearest first.
  std::vector<ScenePoint> within(const Vec3f& point, float radius) const;

  /// The same for each of many points.
  Lists<ScenePoint> within(const PointView& points, float radius, const BatchOptions& options = {}) const;

  /// Every triangle that has a point in `box`, once for each instance, in the order of (instance, mesh,
  /// primitive).
  ///
  /// The corners are moved to the scene first, in double precision, and rounded to floats at last, each once:
  /// a vertex that triangles share stays shared. For the triangles as they are then, the answer is exact, and
  /// touching counts. A triangle that is flattened by this to a line or a point counts as that.
  std::vector<ScenePrimitiveId> triangles_in(const Box3f& box) const;

  /// The same for many boxes.
  Lists<ScenePrimitiveId> triangles_in(std::span<const Box3f> boxes, const BatchOptions& options = {}) const;

  /// Whether a triangle of this scene and one of `other`, moved by `transform`, have a point in common. Stops
  /// at the first pair that is found; see `touching_pairs`.
  bool touches(const Scene& other, const Transform& transform = {}) const;

  /// The same of one hierarchy.
  bool touches(const Bvh& other, const Transform& transform = {}) const;

  /// All pairs of a triangle of this scene and one of `other`, moved by `transform`, that have a point in
  /// common; touching counts. Each pair once for each pair of instances, in the order of (instance, mesh,
  /// primitive) of the first, then of the second.
  ///
  /// The corners of the second are moved to the space of the first one's object by one map, computed in
  /// double precision, and rounded to floats there, each once. For the triangles as they are then, the answer
  /// is exact: that of `Bvh::touching_pairs` for the two objects and that map. Throws
  /// `Error::invalid_argument` if a number of `transform` is not finite or a moved corner has a coordinate of
  /// 2^126 or more, and `Error::out_of_memory`.
  std::vector<SceneTouchingPair> touching_pairs(const Scene& other, const Transform& transform = {},
                                                const BatchOptions& options = {}) const;

  /// The same with one hierarchy, whose triangles are those of instance 0.
  std::vector<SceneTouchingPair> touching_pairs(const Bvh& other, const Transform& transform = {},
                                                const BatchOptions& options = {}) const;

  /// All pairs of triangles of two instances of this scene that have a point in common, the lower instance
  /// first. Pairs within an instance are left to `Bvh::touching_pairs`.
  std::vector<SceneTouchingPair> touching_pairs(const BatchOptions& options = {}) const;

  /// A triangle by its corners in the scene, moved as by `triangles_in`; nothing if it is in no leaf, because
  /// it has no area, or does not exist. As `Bvh::triangle`, which is called for the object.
  std::optional<Triangle> triangle(const ScenePrimitiveId& id) const;

  /// What `ray` meets at `hit`, which a call of this scene gave for it: the triangle as it stands in the
  /// scene, and its normal there, also under scale and shear; a mirrored object has its front where the moved
  /// corners run counter-clockwise. Throws `Error::invalid_argument` for a hit of no triangle; as `triangle`
  /// otherwise.
  HitGeometry geometry(const Ray& ray, const SceneHit& hit) const;

  /// Writes the scene to a file (docs/file-format.md): each hierarchy once, however often it stands in the
  /// scene or in scenes there. The rest is as by `Bvh::save`. Throws `Error::io`, `out_of_memory`, or
  /// `too_large` for 2^31 hierarchies or scenes.
  void save(const FileName& name) const;

  /// The bytes of that file. Throws `Error::out_of_memory` or `too_large`.
  std::vector<std::byte> save() const;

  /// Reads a file that `save` wrote, and builds the top levels again; hits are numbered as before. What was
  /// one hierarchy is one again. Everything is checked before it is used, as by `Bvh::load`, and refused with
  /// `Error::bad_format`. The file of a `Bvh` is a scene of one instance. Also throws `Error::io` or
  /// `out_of_memory`. While any of the hierarchies lives, so does the memory of all.
  static Scene load(const FileName& name);

  /// The same from the bytes of such a file, which are copied. Throws `Error::bad_format` or `out_of_memory`.
  static Scene load(std::span<const std::byte> bytes);

  /// As `load`, with the hierarchies mapped as by `Bvh::map`.
  static Scene map(const FileName& name);

  /// The instances that were given to `build`. Valid as long as this handle or a copy of it.
  std::span<const Instance> instances() const;

  /// How many instances there are, those of scenes at places counted at each: hits number them 0 to this. As
  /// many as `instances()` where no scene stands in this one.
  std::uint32_t instance_count() const;

  /// Which instance the number in a hit or a point stands for: its place in `instances()`, then that in the
  /// scene there, down to an object. One number where no scene stands in this one. Throws
  /// `Error::invalid_argument` for a number that is not below `instance_count`, and `Error::out_of_memory`.
  std::vector<std::uint32_t> path(std::uint32_t instance) const;

  /// Equal for copies of one handle, and for no others that exist at the same time: see `Bvh::identity`.
  const void* identity() const { return structure_.get(); }

  /// A box around all instances; empty for a scene of nothing.
  Box3f bounds() const;

  /// The bytes of the scene itself, without those of its objects.
  std::size_t bytes() const;

 private:
  friend struct SceneStructure;
  explicit Scene(Shared<SceneStructure> structure) noexcept;
  std::vector<SceneHit> list_hits(const Ray& ray) const;
  template <class Call>
  static bool call_filter(void* call, const SceneHit& hit) {
    return (*static_cast<Call*>(call))(hit);
  }
  template <class Filter>
  static bool call_filter_of_many(const void* filter, std::size_t ray, const SceneHit& hit) {
    return static_cast<bool>((*static_cast<const Filter*>(filter))(ray, hit));
  }
  using FilterOfMany = bool (*)(const void* context, std::size_t ray, const SceneHit& hit);
  std::optional<SceneHit> intersect_filtered(const Ray& ray, Mask mask, void* context,
                                             bool (*accept)(void* context, const SceneHit& hit)) const;
  bool occluded_filtered(const Ray& ray, Mask mask, void* context,
                         bool (*accept)(void* context, const SceneHit& hit)) const;
  void intersect_filtered(const RayView& rays, std::span<SceneHit> hits, const BatchOptions& options,
                          const void* context, FilterOfMany accept) const;
  void occluded_filtered(const RayView& rays, const FlagView& occluded, const BatchOptions& options,
                         const void* context, FilterOfMany accept) const;

  Shared<SceneStructure> structure_;
};

/// An object, or a scene of such, at a place in a scene.
struct Instance {
  Bvh object = {};           ///< shared with all other handles: nothing of it is copied
  Scene scene = {};          ///< stands here if it has instances; `object` must be of nothing then
  Transform transform = {};  ///< from the (local) coordinates of the object; invertible, see `build`
  Mask mask = {};            ///< rays that are traced with a `Mask` see it if they share a bit
  std::uint32_t number = 0;  ///< the caller's own, which kerf only keeps
};

/// Scenes may stand in scenes up to this deep; one of objects alone is one level.
inline constexpr unsigned max_scene_levels = 8;

/// Builds a scene. Objects of nothing are allowed. Of the options, `threads` counts. Throws
/// `Error::invalid_argument` for an instance with an object and a scene, and for a transform with a number
/// that is not finite, or that flattens its object so much that it cannot be inverted in double precision
/// (the sum of the absolute values in a row of the product of |transform| and |inverse|, times that of the
/// levels below it, must be below 2^20), or that moves it to coordinates of 2^126 or more; `Error::too_large`
/// for 2^28 instances and more, 2^32 - 1 with those of scenes, and more than `max_scene_levels`; and
/// `Error::out_of_memory`.
KERF_API Scene build(std::span<const Instance> instances, const BuildOptions& options = {});

}  // namespace kerf

#endif  // KERF_HAS_CPP20
