// kerf for programs in C++11 and later: <kerf/kerf.h> with a handle that cleans up after itself, vectors for
// lists, and exceptions. Programs in C++20 have <kerf/kerf.hpp>, which needs none of this.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <kerf/kerf.h>

namespace kerf11 {

/// What went wrong, as a status to branch on and a sentence to show.
class Error : public std::runtime_error {
 public:
  Error(kerf_status status, const std::string& sentence) : std::runtime_error(sentence), status_(status) {}
  kerf_status status() const { return status_; }  ///< which kind of error

 private:
  kerf_status status_;
};

/// Throws what `status`, which a call of this thread has just returned, says.
inline void check(kerf_status status) {
  if (status != KERF_OK) throw Error(status, kerf_last_error());
}

/// A mesh of three floats a vertex and three indices a triangle. The vectors must outlive the view.
inline kerf_mesh mesh(const std::vector<float>& vertices, const std::vector<std::uint32_t>& triangles) {
  if (vertices.size() % 3 != 0 || triangles.size() % 3 != 0)
    throw Error(KERF_INVALID_ARGUMENT, "the size of a flat range is no multiple of three");
  kerf_mesh view = KERF_MESH_INIT;
  view.vertices = vertices.data();
  view.vertex_count = vertices.size() / 3;
  view.triangles = triangles.data();
  view.triangle_count = triangles.size() / 3;
  return view;
}

// What classes below have in common.
namespace detail {

inline kerf_batch_options on(std::uint32_t threads) {
  kerf_batch_options options = KERF_BATCH_OPTIONS_INIT;
  options.threads = threads;
  return options;
}

// Asks for a few answers, and again where there are more.
template <class T, class Call>
std::vector<T> list(const Call& call) {
  std::vector<T> answers(16);
  std::size_t count = 0;
  check(call(answers.data(), answers.size(), &count));
  const bool all = count <= answers.size();
  answers.resize(count);
  if (!all) check(call(answers.data(), answers.size(), &count));
  return answers;
}

}  // namespace detail

/// A hierarchy, ready to trace. A handle: copies share one structure, which never changes but for `refit`, so
/// that any number of threads may make any call at the same time. Calls throw `Error`.
class Bvh {
 public:
  /// The hierarchy of nothing, which every ray misses.
  Bvh() { check(kerf_build(nullptr, 0, nullptr, &bvh_)); }
  /// One hierarchy over several meshes.
  explicit Bvh(const std::vector<kerf_mesh>& meshes, const kerf_build_options* options = nullptr) {
    check(kerf_build(meshes.data(), meshes.size(), options, &bvh_));
  }
  /// The hierarchy of one mesh.
  explicit Bvh(const kerf_mesh& mesh, const kerf_build_options* options = nullptr) {
    check(kerf_build(&mesh, 1, options, &bvh_));
  }
  /// The hierarchy of a mesh in double precision: see `kerf_origin`.
  explicit Bvh(const kerf_double_mesh& mesh, const kerf_build_options* options = nullptr) {
    check(kerf_build_double(&mesh, 1, options, &bvh_));
  }
  /// Reads, or maps, a file that `save` wrote. Paths are UTF-8.
  static Bvh load(const std::string& path) {
    kerf_bvh* bvh;
    check(kerf_load(path.c_str(), &bvh));
    return Bvh(bvh);
  }
  static Bvh map(const std::string& path) {
    kerf_bvh* bvh;
    check(kerf_map(path.c_str(), &bvh));
    return Bvh(bvh);
  }
  /// Takes a handle over.
  explicit Bvh(kerf_bvh* owned) : bvh_(owned) {}

  Bvh(const Bvh& other) : bvh_(kerf_bvh_retain(other.bvh_)) {}
  Bvh(Bvh&& other) : Bvh() { swap(other); }
  Bvh& operator=(Bvh other) {
    swap(other);
    return *this;
  }
  ~Bvh() { kerf_bvh_release(bvh_); }
  void swap(Bvh& other) { std::swap(bvh_, other.bvh_); }
  const kerf_bvh* get() const { return bvh_; }  ///< for what is only in C

  /// Moves the triangles to where `meshes` have them now: see `kerf_refit`. Copies of this handle stay as
  /// they are. No other call of this one may run meanwhile.
  kerf_refit_report refit(const std::vector<kerf_mesh>& meshes, const kerf_build_options* options = nullptr) {
    kerf_refit_report report = KERF_REFIT_REPORT_INIT;
    check(kerf_refit(&bvh_, meshes.data(), meshes.size(), options, &report));
    return report;
  }
  kerf_refit_report refit(const kerf_mesh& mesh, const kerf_build_options* options = nullptr) {
    return refit(std::vector<kerf_mesh>(1, mesh), options);
  }

  void save(const std::string& path) const { check(kerf_save(bvh_, path.c_str())); }
  kerf_box bounds() const { return kerf_bounds(bvh_); }
  kerf_statistics statistics() const {
    kerf_statistics all = KERF_STATISTICS_INIT;
    check(kerf_get_statistics(bvh_, &all));
    return all;
  }

  /// True if there is a hit; `hit` is written in both cases.
  bool intersect(const kerf_ray& ray, kerf_hit& hit) const { return kerf_intersect(bvh_, &ray, &hit) != 0; }
  bool occluded(const kerf_ray& ray) const { return kerf_occluded(bvh_, &ray) != 0; }

  std::vector<kerf_hit> all_hits(const kerf_ray& ray) const {
    return detail::list<kerf_hit>([&](kerf_hit* hits, std::size_t capacity, std::size_t* count) {
      return kerf_all_hits(bvh_, &ray, hits, capacity, count);
    });
  }
  std::size_t count_hits(const kerf_ray& ray) const {
    std::size_t count;
    check(kerf_count_hits(bvh_, &ray, &count));
    return count;
  }

  bool contains(const float (&point)[3]) const {
    int inside;
    check(kerf_contains(bvh_, point, &inside));
    return inside != 0;
  }
  kerf_side side(const float (&point)[3]) const {
    kerf_side side;
    check(kerf_get_side(bvh_, point, &side));
    return side;
  }
  /// Its `primitive` is KERF_INVALID_ID where there is none.
  kerf_surface_point closest_point(const float (&point)[3],
                                   float max_distance = std::numeric_limits<float>::infinity()) const {
    kerf_surface_point closest;
    check(kerf_closest_point(bvh_, point, max_distance, &closest));
    return closest;
  }
  float signed_distance(const float (&point)[3]) const {
    float distance;
    check(kerf_signed_distance(bvh_, point, &distance));
    return distance;
  }
  std::vector<kerf_surface_point> nearest(const float (&point)[3], std::size_t wanted,
                                          float max_distance = std::numeric_limits<float>::infinity()) const {
    return detail::list<kerf_surface_point>(
        [&](kerf_surface_point* to, std::size_t capacity, std::size_t* count) {
          return kerf_nearest(bvh_, point, wanted, max_distance, to, capacity, count);
        });
  }
  std::vector<kerf_surface_point> within(const float (&point)[3], float radius) const {
    return detail::list<kerf_surface_point>(
        [&](kerf_surface_point* to, std::size_t capacity, std::size_t* count) {
          return kerf_within(bvh_, point, radius, to, capacity, count);
        });
  }
  std::vector<kerf_primitive_id> triangles_in(const kerf_box& box) const {
    return detail::list<kerf_primitive_id>(
        [&](kerf_primitive_id* to, std::size_t capacity, std::size_t* count) {
          return kerf_triangles_in(bvh_, &box, to, capacity, count);
        });
  }
  std::vector<kerf_touching_pair> touching_pairs(const Bvh& other,
                                                 const kerf_transform* transform = nullptr) const {
    return detail::list<kerf_touching_pair>(
        [&](kerf_touching_pair* to, std::size_t capacity, std::size_t* count) {
          return kerf_touching_pairs(bvh_, other.bvh_, transform, to, capacity, count);
        });
  }

  /// Many rays on `threads` threads, 0 for all cores.
  std::vector<kerf_hit> intersect(const std::vector<kerf_ray>& rays, std::uint32_t threads = 0) const {
    std::vector<kerf_hit> hits(rays.size());
    const kerf_rays from = kerf_rays_of(rays.data(), rays.size());
    const kerf_hits to = kerf_hits_of(hits.data(), hits.size());
    const kerf_batch_options options = detail::on(threads);
    check(kerf_intersect_many(bvh_, &from, &to, &options));
    return hits;
  }
  std::vector<std::uint8_t> occluded(const std::vector<kerf_ray>& rays, std::uint32_t threads = 0) const {
    std::vector<std::uint8_t> flags(rays.size());
    const kerf_rays from = kerf_rays_of(rays.data(), rays.size());
    const kerf_batch_options options = detail::on(threads);
    check(kerf_occluded_many(bvh_, &from, flags.data(), &options));
    return flags;
  }

 private:
  kerf_bvh* bvh_ = nullptr;
};

class Scene;

/// An object, or a scene, at a place; an unmoved one if no transform is given. The scene that is built of it
/// keeps what it needs; until then the handle must live.
kerf_instance instance(const Bvh& object, const kerf_transform* transform = nullptr);
kerf_instance instance(const Scene& scene, const kerf_transform* transform = nullptr);

/// A hierarchy over instances. A handle as `Bvh` is.
class Scene {
 public:
  /// The scene of nothing, which every ray misses.
  Scene() : Scene(std::vector<kerf_instance>()) {}
  /// A scene of instances, as `instance` makes them.
  explicit Scene(const std::vector<kerf_instance>& instances, const kerf_build_options* options = nullptr) {
    check(kerf_build_scene(instances.data(), instances.size(), options, &scene_));
  }
  /// Takes a handle over.
  explicit Scene(kerf_scene* owned) : scene_(owned) {}

  Scene(const Scene& other) : scene_(kerf_scene_retain(other.scene_)) {}
  Scene(Scene&& other) : Scene() { swap(other); }
  Scene& operator=(Scene other) {
    swap(other);
    return *this;
  }
  ~Scene() { kerf_scene_release(scene_); }
  void swap(Scene& other) { std::swap(scene_, other.scene_); }
  const kerf_scene* get() const { return scene_; }  ///< for what is only in C

  static Scene load(const std::string& path) {
    kerf_scene* loaded = nullptr;
    check(kerf_scene_load(path.c_str(), &loaded));
    return Scene(loaded);
  }
  static Scene map(const std::string& path) {
    kerf_scene* mapped = nullptr;
    check(kerf_scene_map(path.c_str(), &mapped));
    return Scene(mapped);
  }
  void save(const std::string& path) const { check(kerf_scene_save(scene_, path.c_str())); }
  kerf_box bounds() const { return kerf_scene_bounds(scene_); }
  std::size_t bytes() const { return kerf_scene_bytes(scene_); }
  std::uint32_t instance_count() const { return kerf_scene_instance_count(scene_); }
  std::vector<std::uint32_t> path(std::uint32_t instance) const {
    return detail::list<std::uint32_t>([&](std::uint32_t* to, std::size_t capacity, std::size_t* count) {
      return kerf_scene_path(scene_, instance, to, capacity, count);
    });
  }

  /// True if there is a hit; `hit` is written in both cases.
  bool intersect(const kerf_ray& ray, kerf_scene_hit& hit) const {
    return kerf_scene_intersect(scene_, &ray, &hit) != 0;
  }
  bool occluded(const kerf_ray& ray) const { return kerf_scene_occluded(scene_, &ray) != 0; }
  std::vector<kerf_scene_hit> all_hits(const kerf_ray& ray) const {
    return detail::list<kerf_scene_hit>([&](kerf_scene_hit* to, std::size_t capacity, std::size_t* count) {
      return kerf_scene_all_hits(scene_, &ray, to, capacity, count);
    });
  }
  std::size_t count_hits(const kerf_ray& ray) const {
    std::size_t count;
    check(kerf_scene_count_hits(scene_, &ray, &count));
    return count;
  }

  bool contains(const float (&point)[3]) const {
    int inside;
    check(kerf_scene_contains(scene_, point, &inside));
    return inside != 0;
  }
  kerf_side side(const float (&point)[3]) const {
    kerf_side side;
    check(kerf_scene_get_side(scene_, point, &side));
    return side;
  }
  /// Its `primitive` is KERF_INVALID_ID where there is none.
  kerf_scene_point closest_point(const float (&point)[3],
                                 float max_distance = std::numeric_limits<float>::infinity()) const {
    kerf_scene_point closest;
    check(kerf_scene_closest_point(scene_, point, max_distance, &closest));
    return closest;
  }
  float signed_distance(const float (&point)[3]) const {
    float distance;
    check(kerf_scene_signed_distance(scene_, point, &distance));
    return distance;
  }
  std::vector<kerf_scene_point> nearest(const float (&point)[3], std::size_t wanted,
                                        float max_distance = std::numeric_limits<float>::infinity()) const {
    return detail::list<kerf_scene_point>(
        [&](kerf_scene_point* to, std::size_t capacity, std::size_t* count) {
          return kerf_scene_nearest(scene_, point, wanted, max_distance, to, capacity, count);
        });
  }
  std::vector<kerf_scene_point> within(const float (&point)[3], float radius) const {
    return detail::list<kerf_scene_point>(
        [&](kerf_scene_point* to, std::size_t capacity, std::size_t* count) {
          return kerf_scene_within(scene_, point, radius, to, capacity, count);
        });
  }
  std::vector<kerf_scene_primitive_id> triangles_in(const kerf_box& box) const {
    return detail::list<kerf_scene_primitive_id>(
        [&](kerf_scene_primitive_id* to, std::size_t capacity, std::size_t* count) {
          return kerf_scene_triangles_in(scene_, &box, to, capacity, count);
        });
  }
  std::vector<kerf_scene_touching_pair> touching_pairs(const Scene& other,
                                                       const kerf_transform* transform = nullptr) const {
    return detail::list<kerf_scene_touching_pair>(
        [&](kerf_scene_touching_pair* to, std::size_t capacity, std::size_t* count) {
          return kerf_scene_touching_pairs(scene_, other.scene_, transform, to, capacity, count);
        });
  }
  /// Of two instances of this scene.
  std::vector<kerf_scene_touching_pair> touching_pairs() const {
    return detail::list<kerf_scene_touching_pair>(
        [&](kerf_scene_touching_pair* to, std::size_t capacity, std::size_t* count) {
          return kerf_scene_touching_pairs(scene_, nullptr, nullptr, to, capacity, count);
        });
  }

  /// Many rays on `threads` threads, 0 for all cores.
  std::vector<kerf_scene_hit> intersect(const std::vector<kerf_ray>& rays, std::uint32_t threads = 0) const {
    std::vector<kerf_scene_hit> hits(rays.size());
    const kerf_rays from = kerf_rays_of(rays.data(), rays.size());
    const kerf_batch_options options = detail::on(threads);
    check(kerf_scene_intersect_many(scene_, &from, hits.data(), &options));
    return hits;
  }
  std::vector<std::uint8_t> occluded(const std::vector<kerf_ray>& rays, std::uint32_t threads = 0) const {
    std::vector<std::uint8_t> flags(rays.size());
    const kerf_rays from = kerf_rays_of(rays.data(), rays.size());
    const kerf_batch_options options = detail::on(threads);
    check(kerf_scene_occluded_many(scene_, &from, flags.data(), &options));
    return flags;
  }

 private:
  kerf_scene* scene_ = nullptr;
};

inline kerf_instance instance(const Bvh& object, const kerf_transform* transform) {
  kerf_instance placed = KERF_INSTANCE_INIT;
  placed.object = object.get();
  if (transform != nullptr) placed.transform = *transform;
  return placed;
}
inline kerf_instance instance(const Scene& scene, const kerf_transform* transform) {
  kerf_instance placed = KERF_INSTANCE_INIT;
  placed.scene = scene.get();
  if (transform != nullptr) placed.transform = *transform;
  return placed;
}

}  // namespace kerf11
