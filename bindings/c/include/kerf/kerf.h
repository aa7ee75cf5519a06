/* kerf in C99: split bounding volume hierarchies over triangle meshes.
 *
 * - A hierarchy is a handle with a count of its owners: `kerf_bvh_retain` and `kerf_bvh_release`; so is a
 *   scene. Neither ever changes, but for `kerf_refit`, so that any number of threads may make any call at the
 *   same time.
 * - Whatever can fail returns a `kerf_status`; `kerf_last_error` has the sentence. No exception leaves the
 *   library. What failed has written nothing but what is said at the call.
 * - All memory but the handles' own is the caller's. A list goes into an array of the caller's; the number of
 *   all answers comes back, which may be more than fit.
 * - Structs that may grow begin with `struct_size`; their `..._INIT` sets that and every default. A pointer
 *   to options may be null, for all defaults.
 *
 * Coordinates may be in any unit and are below 2^126; t counts in lengths of a ray's direction. Strides are
 * bytes from one element to the next. What each call answers is described at the call of the same name in
 * <kerf/bvh.hpp>, <kerf/refit.hpp> and <kerf/scene.hpp>. */
#ifndef KERF_KERF_H
#define KERF_KERF_H

#include <kerf/version.hpp> /* macros alone */
#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(KERF_C_SHARED)
#ifdef KERF_C_BUILDS
#define KERF_C_API __declspec(dllexport)
#else
#define KERF_C_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define KERF_C_API __attribute__((visibility("default")))
#else
#define KERF_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- What went wrong ---- */

typedef enum kerf_status {
  KERF_OK = 0,
  KERF_INVALID_ARGUMENT = 1,   /* a null pointer, an option or a length that cannot be right */
  KERF_NON_FINITE_VERTEX = 2,  /* a vertex used by a triangle is not a number, infinite, or 2^126 and more */
  KERF_INDEX_OUT_OF_RANGE = 3, /* a triangle names a vertex that does not exist */
  KERF_TOO_LARGE = 4,          /* more references than 32 bits can number */
  KERF_OUT_OF_MEMORY = 5,      /* an allocation failed; everything allocated before has been freed */
  KERF_CANCELLED = 6,          /* the progress callback asked to stop */
  KERF_IO = 7,                 /* a file cannot be opened, read, written or renamed */
  KERF_BAD_FORMAT = 8,         /* a file is not what its name or its header says */
  KERF_INTERNAL = 9            /* a fault of the library itself */
} kerf_status;

/* The sentence of the last call of this thread that failed; empty if none has. Valid until the next fails. */
KERF_C_API const char* kerf_last_error(void);

/* The KERF_VERSION_NUMBER of the library that runs. */
KERF_C_API uint32_t kerf_version(void);

/* ---- Values ---- */

/* Stands for no triangle, no mesh and no instance. */
#define KERF_INVALID_ID 0xffffffffu

/* The points origin + t * direction with t_min <= t <= t_max. */
typedef struct kerf_ray {
  float origin[3];
  float direction[3]; /* of any length but 0 */
  float t_min;        /* may be negative, or minus infinity */
  float t_max;        /* may be infinity */
} kerf_ray;

/* At (1 - u - v) * v0 + u * v1 + v * v2. `primitive` is KERF_INVALID_ID and t infinity for a miss. */
typedef struct kerf_hit {
  float t, u, v;
  uint32_t primitive; /* number of the triangle within its mesh */
  uint32_t mesh;      /* number of the mesh in the order given to the build */
} kerf_hit;

/* The point of a triangle that is closest to a given point. `primitive` is KERF_INVALID_ID for none. */
typedef struct kerf_surface_point {
  float position[3];
  float distance; /* from the given point */
  float u, v;     /* weights of v1 and v2 */
  uint32_t primitive;
  uint32_t mesh;
} kerf_surface_point;

typedef struct kerf_primitive_id {
  uint32_t primitive; /* number of the triangle within its mesh */
  uint32_t mesh;      /* number of the mesh in the order given to the build */
} kerf_primitive_id;

typedef struct kerf_touching_pair {
  kerf_primitive_id first;  /* of the hierarchy that was asked */
  kerf_primitive_id second; /* of the other */
} kerf_touching_pair;

typedef struct kerf_triangle {
  float v0[3], v1[3], v2[3];
} kerf_triangle;

/* Both ends included. Empty where a lower coordinate is above the upper one. */
typedef struct kerf_box {
  float lower[3], upper[3];
} kerf_box;

/* (x, y, z) becomes rows[i][0] * x + rows[i][1] * y + rows[i][2] * z + rows[i][3] for i = 0, 1 and 2. */
typedef struct kerf_transform {
  double rows[3][4];
} kerf_transform;

/* Where a point lies with regard to a closed surface. */
typedef enum kerf_side { KERF_OUTSIDE = 0, KERF_ON = 1, KERF_INSIDE = 2 } kerf_side;

/* ---- Meshes and builds ---- */

/* One indexed mesh in the caller's memory, which may be freed as soon as the build has returned. */
typedef struct kerf_mesh {
  size_t struct_size;
  const float* vertices; /* three floats each */
  size_t vertex_count;
  size_t vertex_stride;      /* 0: 12 */
  const uint32_t* triangles; /* three vertex numbers each */
  size_t triangle_count;
  size_t triangle_stride; /* 0: 12 */
  uint32_t mask;          /* rays that are traced with a mask see the mesh if they share a bit */
} kerf_mesh;
#define KERF_MESH_INIT \
  { sizeof(kerf_mesh), NULL, 0, 0, NULL, 0, 0, 0xffffffffu }

/* The same in double precision, for scenes far from the origin: see `kerf_origin`. */
typedef struct kerf_double_mesh {
  size_t struct_size;
  const double* vertices; /* three doubles each */
  size_t vertex_count;
  size_t vertex_stride;  /* 0: 24 */
  const void* triangles; /* three vertex numbers each, of index_bits */
  size_t triangle_count;
  size_t triangle_stride; /* 0: without a gap */
  uint32_t index_bits;    /* 32 or 64 */
  uint32_t mask;
} kerf_double_mesh;
#define KERF_DOUBLE_MESH_INIT \
  { sizeof(kerf_double_mesh), NULL, 0, 0, NULL, 0, 0, 32, 0xffffffffu }

typedef enum kerf_builder { KERF_SBVH = 0, KERF_BVH = 1, KERF_ESC = 2, KERF_EVH = 3 } kerf_builder;

/* How much time a build spends on the tree, as `Quality` in <kerf/build.hpp>. */
typedef enum kerf_quality { KERF_FAST = 0, KERF_HIGH = 1, KERF_BEST = 2 } kerf_quality;

/* What becomes of triangles with a vertex that is not finite. */
typedef enum kerf_non_finite { KERF_REFUSE = 0, KERF_SKIP = 1 } kerf_non_finite;

/* As `BuildOptions` in <kerf/build.hpp>. */
typedef struct kerf_build_options {
  size_t struct_size;
  int32_t builder;            /* kerf_builder */
  float alpha;                /* in [0, 1] */
  float max_reference_ratio;  /* references per triangle at most, in [1, 16] */
  uint32_t max_leaf_size;     /* in [1, 8] */
  uint32_t threads;           /* 0: all */
  int32_t non_finite;         /* kerf_non_finite */
  size_t presplit_references; /* for KERF_ESC and KERF_EVH */
  /* Called now and then, from any thread but never from two at once, with a fraction in [0, 1] that never
   * falls. Returning 0 cancels the build. May be null. */
  int (*progress)(void* context, float fraction);
  void* context;                 /* for `progress` */
  double max_refinement_seconds; /* KERF_HIGH and KERF_BEST end after this time; 0: no limit */
  int32_t quality;               /* kerf_quality */
  int32_t unused;                /* 0 */
  const kerf_ray* sample_rays;   /* such as will be traced: the tree is made for them; may be null */
  size_t sample_ray_count;
} kerf_build_options;
#define KERF_BUILD_OPTIONS_INIT                                                                              \
  {                                                                                                          \
    sizeof(kerf_build_options), KERF_SBVH, 1e-5f, 1.5f, 8, 0, KERF_REFUSE, 0, NULL, NULL, 0.0, KERF_FAST, 0, \
        NULL, 0                                                                                              \
  }

typedef struct kerf_bvh kerf_bvh;

/* One hierarchy over `mesh_count` meshes, which belongs to the caller. On failure *bvh is null. */
KERF_C_API kerf_status kerf_build(const kerf_mesh* meshes, size_t mesh_count,
                                  const kerf_build_options* options, kerf_bvh** bvh);
KERF_C_API kerf_status kerf_build_double(const kerf_double_mesh* meshes, size_t mesh_count,
                                         const kerf_build_options* options, kerf_bvh** bvh);
/* The most bytes that a build of so many triangles by KERF_SBVH or KERF_BVH holds at once. */
KERF_C_API kerf_status kerf_build_memory_bound(size_t triangle_count, const kerf_build_options* options,
                                               size_t* bytes);

/* What a refit has made of a hierarchy. */
typedef struct kerf_refit_report {
  size_t struct_size;
  double
      cost_ratio;  /* what a random ray is expected to cost, over what it cost when built; 1.2: build anew */
  int32_t rebuilt; /* 1 if the hierarchy was built anew, because a triangle that it lacks has an area now */
} kerf_refit_report;
#define KERF_REFIT_REPORT_INIT \
  { sizeof(kerf_refit_report), 1.0, 0 }

/* Moves the triangles of *bvh to where `meshes` have them now: as many meshes as were built, with as many
 * triangles each. In place where the caller is the only owner. Where there are others, and in a scene there
 * are, theirs stays as it is: the caller's share of it is released and *bvh becomes another handle. No other
 * call of *bvh may run meanwhile. `report` may be null. After a failure *bvh is what it was, unless memory
 * ran out in the middle: then it is a hierarchy of nothing. */
KERF_C_API kerf_status kerf_refit(kerf_bvh** bvh, const kerf_mesh* meshes, size_t mesh_count,
                                  const kerf_build_options* options, kerf_refit_report* report);

/* One owner more, and one less; the last one frees the hierarchy. Null is allowed. */
KERF_C_API kerf_bvh* kerf_bvh_retain(const kerf_bvh* bvh);
KERF_C_API void kerf_bvh_release(const kerf_bvh* bvh);

/* Paths are UTF-8. On failure *bvh is null. */
KERF_C_API kerf_status kerf_save(const kerf_bvh* bvh, const char* path);
KERF_C_API kerf_status kerf_load(const char* path, kerf_bvh** bvh);
KERF_C_API kerf_status kerf_map(const char* path, kerf_bvh** bvh);

/* What a build made, and what it cost: as `BvhStatistics` in <kerf/bvh.hpp>. */
typedef struct kerf_statistics {
  size_t struct_size;
  size_t triangles, degenerate_triangles, non_finite_triangles, degenerate_by_rounding;
  size_t references, nodes, bytes, build_peak_bytes;
  double build_seconds;
} kerf_statistics;
#define KERF_STATISTICS_INIT \
  { sizeof(kerf_statistics), 0, 0, 0, 0, 0, 0, 0, 0, 0.0 }
KERF_C_API kerf_status kerf_get_statistics(const kerf_bvh* bvh, kerf_statistics* statistics);

typedef struct kerf_mesh_statistics {
  size_t triangles, left_out, references;
  kerf_box bounds;
} kerf_mesh_statistics;
/* Of the first `capacity` meshes; *count becomes the number of all. */
KERF_C_API kerf_status kerf_get_mesh_statistics(const kerf_bvh* bvh, kerf_mesh_statistics* statistics,
                                                size_t capacity, size_t* count);

KERF_C_API kerf_box kerf_bounds(const kerf_bvh* bvh);

/* Where the local frame of a build of doubles lies, and the way there and back. 0 for other builds. */
KERF_C_API void kerf_origin(const kerf_bvh* bvh, double origin[3]);
KERF_C_API void kerf_to_local(const kerf_bvh* bvh, const double point[3], float local[3]);
KERF_C_API void kerf_from_local(const kerf_bvh* bvh, const float local[3], double point[3]);

/* ---- One question ---- */

/* The two calls without a status cannot fail; no pointer may be null. */

/* The closest hit. 1 if there is one, else 0; *hit is written in both cases. */
KERF_C_API int kerf_intersect(const kerf_bvh* bvh, const kerf_ray* ray, kerf_hit* hit);
/* 1 if anything is hit, else 0. */
KERF_C_API int kerf_occluded(const kerf_bvh* bvh, const kerf_ray* ray);

/* Whether a hit counts: not 0. Asked at most once for each triangle and ray. */
typedef int (*kerf_filter)(void* context, const kerf_hit* hit);

/* Of the meshes that share a bit with `mask`, the hits that `filter` accepts, or all where it is null. */
KERF_C_API kerf_status kerf_intersect_filtered(const kerf_bvh* bvh, const kerf_ray* ray, uint32_t mask,
                                               kerf_filter filter, void* context, kerf_hit* hit);
KERF_C_API kerf_status kerf_occluded_filtered(const kerf_bvh* bvh, const kerf_ray* ray, uint32_t mask,
                                              kerf_filter filter, void* context, int* occluded);

/* Every crossing once, in order: the first `capacity` into `hits`; *count becomes the number of all. */
KERF_C_API kerf_status kerf_all_hits(const kerf_bvh* bvh, const kerf_ray* ray, kerf_hit* hits,
                                     size_t capacity, size_t* count);
/* The same one by one, until `visit` returns 0. */
KERF_C_API kerf_status kerf_visit_hits(const kerf_bvh* bvh, const kerf_ray* ray, kerf_filter visit,
                                       void* context);
KERF_C_API kerf_status kerf_count_hits(const kerf_bvh* bvh, const kerf_ray* ray, size_t* count);

/* 1 inside a closed surface or on it, else 0. */
KERF_C_API kerf_status kerf_contains(const kerf_bvh* bvh, const float point[3], int* inside);
KERF_C_API kerf_status kerf_get_side(const kerf_bvh* bvh, const float point[3], kerf_side* side);

/* The closest point within `max_distance`, which may be infinity; its primitive is KERF_INVALID_ID if there
 * is none. */
KERF_C_API kerf_status kerf_closest_point(const kerf_bvh* bvh, const float point[3], float max_distance,
                                          kerf_surface_point* closest);
/* Negative inside. */
KERF_C_API kerf_status kerf_signed_distance(const kerf_bvh* bvh, const float point[3], float* distance);

/* Lists: the first `capacity` answers are written, and *count becomes the number of all. */
KERF_C_API kerf_status kerf_nearest(const kerf_bvh* bvh, const float point[3], size_t wanted,
                                    float max_distance, kerf_surface_point* nearest, size_t capacity,
                                    size_t* count);
KERF_C_API kerf_status kerf_within(const kerf_bvh* bvh, const float point[3], float radius,
                                   kerf_surface_point* points, size_t capacity, size_t* count);
KERF_C_API kerf_status kerf_triangles_in(const kerf_bvh* bvh, const kerf_box* box, kerf_primitive_id* ids,
                                         size_t capacity, size_t* count);

/* Mesh against mesh, the other one moved. A null transform moves nothing. */
KERF_C_API kerf_status kerf_touches(const kerf_bvh* bvh, const kerf_bvh* other,
                                    const kerf_transform* transform, int* touch);
KERF_C_API kerf_status kerf_touching_pairs(const kerf_bvh* bvh, const kerf_bvh* other,
                                           const kerf_transform* transform, kerf_touching_pair* pairs,
                                           size_t capacity, size_t* count);

/* The corners of a triangle; *found becomes 0 for one that is in no leaf or does not exist, else 1. */
KERF_C_API kerf_status kerf_get_triangle(const kerf_bvh* bvh, kerf_primitive_id id, kerf_triangle* triangle,
                                         int* found);

/* What a ray meets at a hit that a call of this hierarchy gave for it. */
typedef struct kerf_hit_geometry {
  kerf_triangle triangle;
  float normal[3]; /* of unit length, to the side from which v0, v1, v2 run counter-clockwise */
  int32_t front;   /* 1 if the ray comes from that side */
} kerf_hit_geometry;
KERF_C_API kerf_status kerf_get_geometry(const kerf_bvh* bvh, const kerf_ray* ray, const kerf_hit* hit,
                                         kerf_hit_geometry* geometry);

/* ---- Many questions ---- */

typedef struct kerf_batch_options {
  size_t struct_size;
  uint32_t threads; /* 0: all */
} kerf_batch_options;
#define KERF_BATCH_OPTIONS_INIT \
  { sizeof(kerf_batch_options), 0 }

/* One number for each of many rays or hits, at any address and stride; strides may be 0 or negative. */
typedef struct kerf_const_floats {
  const float* data;
  ptrdiff_t stride;
} kerf_const_floats;
typedef struct kerf_const_uints {
  const uint32_t* data;
  ptrdiff_t stride;
} kerf_const_uints;
typedef struct kerf_floats {
  float* data;
  ptrdiff_t stride;
} kerf_floats;
typedef struct kerf_uints {
  uint32_t* data;
  ptrdiff_t stride;
} kerf_uints;

/* Many rays, each of their numbers anywhere. */
typedef struct kerf_rays {
  size_t struct_size;
  size_t count;
  kerf_const_floats origin[3], direction[3];
  kerf_const_floats t_min; /* null: 0 for all */
  kerf_const_floats t_max; /* null: infinity for all */
  kerf_const_uints mask;   /* null: all bits for all */
} kerf_rays;

/* Where their hits go. A field whose address is null is not written. */
typedef struct kerf_hits {
  size_t struct_size;
  size_t count;
  kerf_floats t, u, v;
  kerf_uints primitive, mesh;
} kerf_hits;

typedef struct kerf_points {
  size_t struct_size;
  const float* data; /* three floats each */
  size_t count;
  size_t stride; /* 0: 12 */
} kerf_points;

/* Arrays of `kerf_ray`, of `kerf_hit`, and of three floats, as what the calls below take. */
KERF_C_API kerf_rays kerf_rays_of(const kerf_ray* rays, size_t count);
KERF_C_API kerf_hits kerf_hits_of(kerf_hit* hits, size_t count);
KERF_C_API kerf_points kerf_points_of(const float* points, size_t count);

KERF_C_API kerf_status kerf_intersect_many(const kerf_bvh* bvh, const kerf_rays* rays, const kerf_hits* hits,
                                           const kerf_batch_options* options);
/* Flags become 1 or 0. `occluded` has a byte for each ray. */
KERF_C_API kerf_status kerf_occluded_many(const kerf_bvh* bvh, const kerf_rays* rays, uint8_t* occluded,
                                          const kerf_batch_options* options);

/* Whether hit `hit` of ray number `ray` counts. Called from all threads at once. */
typedef int (*kerf_filter_of_many)(void* context, size_t ray, const kerf_hit* hit);
KERF_C_API kerf_status kerf_intersect_many_filtered(const kerf_bvh* bvh, const kerf_rays* rays,
                                                    kerf_filter_of_many filter, void* context,
                                                    const kerf_hits* hits, const kerf_batch_options* options);
KERF_C_API kerf_status kerf_occluded_many_filtered(const kerf_bvh* bvh, const kerf_rays* rays,
                                                   kerf_filter_of_many filter, void* context,
                                                   uint8_t* occluded, const kerf_batch_options* options);

KERF_C_API kerf_status kerf_count_hits_many(const kerf_bvh* bvh, const kerf_rays* rays, uint32_t* counts,
                                            const kerf_batch_options* options);
/* The hits of ray i go to hits[offsets[i]] and on, up to offsets[i + 1]. There is one more offset than rays;
 * sums of what `kerf_count_hits_many` gives fit. `capacity` is the length of `hits`. */
KERF_C_API kerf_status kerf_all_hits_many(const kerf_bvh* bvh, const kerf_rays* rays, const size_t* offsets,
                                          kerf_hit* hits, size_t capacity, const kerf_batch_options* options);

KERF_C_API kerf_status kerf_contains_many(const kerf_bvh* bvh, const kerf_points* points, uint8_t* inside,
                                          const kerf_batch_options* options);
/* Each side is a `kerf_side` in a byte. */
KERF_C_API kerf_status kerf_side_many(const kerf_bvh* bvh, const kerf_points* points, uint8_t* sides,
                                      const kerf_batch_options* options);
KERF_C_API kerf_status kerf_closest_point_many(const kerf_bvh* bvh, const kerf_points* points,
                                               float max_distance, kerf_surface_point* closest,
                                               const kerf_batch_options* options);
KERF_C_API kerf_status kerf_signed_distance_many(const kerf_bvh* bvh, const kerf_points* points,
                                                 float* distances, const kerf_batch_options* options);

/* Lists for many: list i is what stands from offsets[i] up to offsets[i + 1] among all answers, of which the
 * first `capacity` are written. `offsets` has one more entry than there are questions, and its last is the
 * number of all answers. */
KERF_C_API kerf_status kerf_nearest_many(const kerf_bvh* bvh, const kerf_points* points, size_t wanted,
                                         float max_distance, size_t* offsets, kerf_surface_point* nearest,
                                         size_t capacity, const kerf_batch_options* options);
KERF_C_API kerf_status kerf_within_many(const kerf_bvh* bvh, const kerf_points* points, float radius,
                                        size_t* offsets, kerf_surface_point* found, size_t capacity,
                                        const kerf_batch_options* options);
KERF_C_API kerf_status kerf_triangles_in_many(const kerf_bvh* bvh, const kerf_box* boxes, size_t count,
                                              size_t* offsets, kerf_primitive_id* ids, size_t capacity,
                                              const kerf_batch_options* options);

/* ---- Threads of the caller's own ---- */

/* A pool of threads that the caller has already. Both functions may be called from any thread, and from
 * several at once. */
typedef struct kerf_thread_pool {
  size_t struct_size;
  void* context;
  /* How many threads may work on one call, that which makes the call included. */
  uint32_t (*threads)(void* context);
  /* Has task(data) called once, on any thread of the pool, now or later: at the latest before the pool ends.
   * It ends when there is nothing to help with. 0: the pool takes no more, and will not call it. */
  int (*start)(void* context, void (*task)(void* data), void* data);
} kerf_thread_pool;
#define KERF_THREAD_POOL_INIT \
  { sizeof(kerf_thread_pool), NULL, NULL, NULL }

/* Calls work(context), and runs all calls of kerf that it makes on this thread and those of the pool, as
 * `run_on` in <kerf/threads.hpp>. No call waits for a task that the pool has not begun. */
KERF_C_API kerf_status kerf_run_on(const kerf_thread_pool* pool, void (*work)(void* context), void* context);

/* ---- Scenes: hierarchies at places ---- */

/* A hierarchy over instances, which may be scenes themselves, up to eight levels deep. */
typedef struct kerf_scene kerf_scene;

/* An object, or a scene, at a place in a scene. One of the two is null. */
typedef struct kerf_instance {
  size_t struct_size;
  const kerf_bvh* object;
  const kerf_scene* scene;
  kerf_transform transform; /* from the (local) coordinates of the object to those of the scene; invertible */
  uint32_t mask;            /* rays that are traced with a mask see it if they share a bit */
  uint32_t number;          /* the caller's own */
} kerf_instance;
#define KERF_INSTANCE_INIT \
  { sizeof(kerf_instance), NULL, NULL, {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, 0xffffffffu, 0 }

/* As `kerf_hit`, and the number of the instance, see `kerf_scene_path`; KERF_INVALID_ID for a miss. */
typedef struct kerf_scene_hit {
  float t, u, v;
  uint32_t primitive; /* number of the triangle within its mesh */
  uint32_t mesh;      /* number of the mesh within the object */
  uint32_t instance;
} kerf_scene_hit;

/* As `kerf_surface_point`, in the scene, and the number of the instance; KERF_INVALID_ID for none. */
typedef struct kerf_scene_point {
  float position[3];
  float distance; /* from the given point */
  float u, v;     /* weights of v1 and v2 */
  uint32_t primitive;
  uint32_t mesh;
  uint32_t instance;
} kerf_scene_point;

/* A triangle of an instance. */
typedef struct kerf_scene_primitive_id {
  uint32_t primitive; /* number of the triangle within its mesh */
  uint32_t mesh;      /* number of the mesh within the object */
  uint32_t instance;
} kerf_scene_primitive_id;

/* Two triangles of instances that have a point in common. */
typedef struct kerf_scene_touching_pair {
  kerf_scene_primitive_id first;  /* of the scene that was asked */
  kerf_scene_primitive_id second; /* of the other */
} kerf_scene_touching_pair;

/* One scene, which belongs to the caller and is an owner of what stands in it. Of the options, `threads`
 * counts. On failure *scene is null. */
KERF_C_API kerf_status kerf_build_scene(const kerf_instance* instances, size_t instance_count,
                                        const kerf_build_options* options, kerf_scene** scene);

/* As `kerf_save`, `kerf_load` and `kerf_map`: hierarchies are in the file once, however often they stand in
 * the scene. The file of a hierarchy is a scene of one instance. */
KERF_C_API kerf_status kerf_scene_save(const kerf_scene* scene, const char* path);
KERF_C_API kerf_status kerf_scene_load(const char* path, kerf_scene** scene);
KERF_C_API kerf_status kerf_scene_map(const char* path, kerf_scene** scene);

/* One owner more, and one less; the last one frees the scene. Null is allowed. */
KERF_C_API kerf_scene* kerf_scene_retain(const kerf_scene* scene);
KERF_C_API void kerf_scene_release(const kerf_scene* scene);

/* How many instances there are, those of scenes at places counted at each: hits number them 0 to this. */
KERF_C_API uint32_t kerf_scene_instance_count(const kerf_scene* scene);
/* Which instance a number stands for: its place among those given to the build, then that in the scene there,
 * down to an object. The first `capacity` numbers are written; *count becomes that of all. */
KERF_C_API kerf_status kerf_scene_path(const kerf_scene* scene, uint32_t instance, uint32_t* path,
                                       size_t capacity, size_t* count);
/* One of the instances as it was given to the build. Its handles are the scene's: valid as long as it is. */
KERF_C_API kerf_status kerf_scene_get_instance(const kerf_scene* scene, size_t place,
                                               kerf_instance* instance);
KERF_C_API kerf_box kerf_scene_bounds(const kerf_scene* scene);
/* Of the scene itself, without its objects. */
KERF_C_API size_t kerf_scene_bytes(const kerf_scene* scene);

/* The closest hit. 1 if there is one, else 0; *hit is written in both cases. Neither this nor the next call
 * can fail; no pointer may be null. */
KERF_C_API int kerf_scene_intersect(const kerf_scene* scene, const kerf_ray* ray, kerf_scene_hit* hit);
/* 1 if anything is hit, else 0. */
KERF_C_API int kerf_scene_occluded(const kerf_scene* scene, const kerf_ray* ray);
/* Of instances and meshes that share a bit with `mask`. */
KERF_C_API kerf_status kerf_scene_intersect_masked(const kerf_scene* scene, const kerf_ray* ray,
                                                   uint32_t mask, kerf_scene_hit* hit);
KERF_C_API kerf_status kerf_scene_occluded_masked(const kerf_scene* scene, const kerf_ray* ray, uint32_t mask,
                                                  int* occluded);

/* Whether a hit counts: not 0. Asked at most once for each triangle of each instance and ray. */
typedef int (*kerf_scene_filter)(void* context, const kerf_scene_hit* hit);
/* Of instances and meshes that share a bit with `mask`, the hits that `filter` accepts, or all where it is
 * null. */
KERF_C_API kerf_status kerf_scene_intersect_filtered(const kerf_scene* scene, const kerf_ray* ray,
                                                     uint32_t mask, kerf_scene_filter filter, void* context,
                                                     kerf_scene_hit* hit);
KERF_C_API kerf_status kerf_scene_occluded_filtered(const kerf_scene* scene, const kerf_ray* ray,
                                                    uint32_t mask, kerf_scene_filter filter, void* context,
                                                    int* occluded);

/* Each triangle once for each instance, in the order of (t, instance, mesh, primitive). */
KERF_C_API kerf_status kerf_scene_all_hits(const kerf_scene* scene, const kerf_ray* ray, kerf_scene_hit* hits,
                                           size_t capacity, size_t* count);
KERF_C_API kerf_status kerf_scene_count_hits(const kerf_scene* scene, const kerf_ray* ray, size_t* count);
/* 1 inside the closed surface that all triangles make, or on it, else 0. Where two overlap is outside. */
KERF_C_API kerf_status kerf_scene_contains(const kerf_scene* scene, const float point[3], int* inside);
KERF_C_API kerf_status kerf_scene_get_side(const kerf_scene* scene, const float point[3], kerf_side* side);
KERF_C_API kerf_status kerf_scene_closest_point(const kerf_scene* scene, const float point[3],
                                                float max_distance, kerf_scene_point* closest);
KERF_C_API kerf_status kerf_scene_signed_distance(const kerf_scene* scene, const float point[3],
                                                  float* distance);
KERF_C_API kerf_status kerf_scene_nearest(const kerf_scene* scene, const float point[3], size_t wanted,
                                          float max_distance, kerf_scene_point* nearest, size_t capacity,
                                          size_t* count);
KERF_C_API kerf_status kerf_scene_within(const kerf_scene* scene, const float point[3], float radius,
                                         kerf_scene_point* points, size_t capacity, size_t* count);
/* Each triangle once for each instance, in the order of (instance, mesh, primitive). Exact for triangles
 * whose corners are moved to the scene in double precision and rounded to floats once. */
KERF_C_API kerf_status kerf_scene_triangles_in(const kerf_scene* scene, const kerf_box* box,
                                               kerf_scene_primitive_id* ids, size_t capacity, size_t* count);
/* As `kerf_get_triangle` and `kerf_get_geometry`, in the coordinates of the scene. */
KERF_C_API kerf_status kerf_scene_get_triangle(const kerf_scene* scene, kerf_scene_primitive_id id,
                                               kerf_triangle* triangle, int* found);
KERF_C_API kerf_status kerf_scene_get_geometry(const kerf_scene* scene, const kerf_ray* ray,
                                               const kerf_scene_hit* hit, kerf_hit_geometry* geometry);
/* All pairs of a triangle of `scene` and one of `other`, moved by `transform` (null: not at all); each once
 * for each pair of instances, in the order of (instance, mesh, primitive) of the first, then of the second.
 * Exact as `kerf_touching_pairs` is, for corners of the second that are moved to the space of the first one's
 * object. Where `other` is null: of two instances of `scene`, the lower one first; `transform` is null then.
 */
KERF_C_API kerf_status kerf_scene_touching_pairs(const kerf_scene* scene, const kerf_scene* other,
                                                 const kerf_transform* transform,
                                                 kerf_scene_touching_pair* pairs, size_t capacity,
                                                 size_t* count);
/* Whether there is a pair with `other`, which is not null. */
KERF_C_API kerf_status kerf_scene_touches(const kerf_scene* scene, const kerf_scene* other,
                                          const kerf_transform* transform, int* touch);

/* Many: as the calls for hierarchies, in arrays of what one call answers with. */
KERF_C_API kerf_status kerf_scene_intersect_many(const kerf_scene* scene, const kerf_rays* rays,
                                                 kerf_scene_hit* hits, const kerf_batch_options* options);
KERF_C_API kerf_status kerf_scene_occluded_many(const kerf_scene* scene, const kerf_rays* rays,
                                                uint8_t* occluded, const kerf_batch_options* options);
/* Whether hit `hit` of ray number `ray` counts. Called from all threads at once. */
typedef int (*kerf_scene_filter_of_many)(void* context, size_t ray, const kerf_scene_hit* hit);
KERF_C_API kerf_status kerf_scene_intersect_many_filtered(const kerf_scene* scene, const kerf_rays* rays,
                                                          kerf_scene_filter_of_many filter, void* context,
                                                          kerf_scene_hit* hits,
                                                          const kerf_batch_options* options);
KERF_C_API kerf_status kerf_scene_occluded_many_filtered(const kerf_scene* scene, const kerf_rays* rays,
                                                         kerf_scene_filter_of_many filter, void* context,
                                                         uint8_t* occluded,
                                                         const kerf_batch_options* options);
KERF_C_API kerf_status kerf_scene_count_hits_many(const kerf_scene* scene, const kerf_rays* rays,
                                                  uint32_t* counts, const kerf_batch_options* options);
/* The next and the last three have lists, as `kerf_within_many` has them. */
KERF_C_API kerf_status kerf_scene_all_hits_many(const kerf_scene* scene, const kerf_rays* rays,
                                                size_t* offsets, kerf_scene_hit* hits, size_t capacity,
                                                const kerf_batch_options* options);
KERF_C_API kerf_status kerf_scene_contains_many(const kerf_scene* scene, const kerf_points* points,
                                                uint8_t* inside, const kerf_batch_options* options);
KERF_C_API kerf_status kerf_scene_side_many(const kerf_scene* scene, const kerf_points* points,
                                            uint8_t* sides, const kerf_batch_options* options);
KERF_C_API kerf_status kerf_scene_closest_point_many(const kerf_scene* scene, const kerf_points* points,
                                                     float max_distance, kerf_scene_point* closest,
                                                     const kerf_batch_options* options);
KERF_C_API kerf_status kerf_scene_signed_distance_many(const kerf_scene* scene, const kerf_points* points,
                                                       float* distances, const kerf_batch_options* options);
KERF_C_API kerf_status kerf_scene_nearest_many(const kerf_scene* scene, const kerf_points* points,
                                               size_t wanted, float max_distance, size_t* offsets,
                                               kerf_scene_point* nearest, size_t capacity,
                                               const kerf_batch_options* options);
KERF_C_API kerf_status kerf_scene_within_many(const kerf_scene* scene, const kerf_points* points,
                                              float radius, size_t* offsets, kerf_scene_point* found,
                                              size_t capacity, const kerf_batch_options* options);
KERF_C_API kerf_status kerf_scene_triangles_in_many(const kerf_scene* scene, const kerf_box* boxes,
                                                    size_t count, size_t* offsets,
                                                    kerf_scene_primitive_id* ids, size_t capacity,
                                                    const kerf_batch_options* options);

#ifdef __cplusplus
}
#endif

#endif
