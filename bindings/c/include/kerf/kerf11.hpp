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

/// A hierarchy, ready to trace. A handle: copies share one structure, which never changes, so that any number
/// of threads may make any call at the same time. Calls throw `Error`.
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
    return list<kerf_hit>([&](kerf_hit* hits, std::size_t capacity, std::size_t* count) {
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
    return list<kerf_surface_point>([&](kerf_surface_point* to, std::size_t capacity, std::size_t* count) {
      return kerf_nearest(bvh_, point, wanted, max_distance, to, capacity, count);
    });
  }
  std::vector<kerf_surface_point> within(const float (&point)[3], float radius) const {
    return list<kerf_surface_point>([&](kerf_surface_point* to, std::size_t capacity, std::size_t* count) {
      return kerf_within(bvh_, point, radius, to, capacity, count);
    });
  }
  std::vector<kerf_primitive_id> triangles_in(const kerf_box& box) const {
    return list<kerf_primitive_id>([&](kerf_primitive_id* to, std::size_t capacity, std::size_t* count) {
      return kerf_triangles_in(bvh_, &box, to, capacity, count);
    });
  }
  std::vector<kerf_touching_pair> touching_pairs(const Bvh& other,
                                                 const kerf_transform* transform = nullptr) const {
    return list<kerf_touching_pair>([&](kerf_touching_pair* to, std::size_t capacity, std::size_t* count) {
      return kerf_touching_pairs(bvh_, other.bvh_, transform, to, capacity, count);
    });
  }

  /// Many rays on `threads` threads, 0 for all cores.
  std::vector<kerf_hit> intersect(const std::vector<kerf_ray>& rays, std::uint32_t threads = 0) const {
    std::vector<kerf_hit> hits(rays.size());
    const kerf_rays from = kerf_rays_of(rays.data(), rays.size());
    const kerf_hits to = kerf_hits_of(hits.data(), hits.size());
    const kerf_batch_options options = on(threads);
    check(kerf_intersect_many(bvh_, &from, &to, &options));
    return hits;
  }
  std::vector<std::uint8_t> occluded(const std::vector<kerf_ray>& rays, std::uint32_t threads = 0) const {
    std::vector<std::uint8_t> flags(rays.size());
    const kerf_rays from = kerf_rays_of(rays.data(), rays.size());
    const kerf_batch_options options = on(threads);
    check(kerf_occluded_many(bvh_, &from, flags.data(), &options));
    return flags;
  }

 private:
  static kerf_batch_options on(std::uint32_t threads) {
    kerf_batch_options options = KERF_BATCH_OPTIONS_INIT;
    options.threads = threads;
    return options;
  }
  // Asks for a few answers, and again where there are more.
  template <class T, class Call>
  static std::vector<T> list(const Call& call) {
    std::vector<T> answers(16);
    std::size_t count = 0;
    check(call(answers.data(), answers.size(), &count));
    const bool all = count <= answers.size();
    answers.resize(count);
    if (!all) check(call(answers.data(), answers.size(), &count));
    return answers;
  }

  kerf_bvh* bvh_ = nullptr;
};

}  // namespace kerf11
