// The C interface: every call of <kerf/bvh.hpp>, <kerf/refit.hpp>, <kerf/scene.hpp> and <kerf/threads.hpp> in
// plain functions.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <filesystem>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include <kerf/kerf.h>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>
#include <kerf/threads.hpp>

struct kerf_bvh {
  explicit kerf_bvh(kerf::Bvh made) : bvh(std::move(made)) {}

  mutable std::atomic<std::size_t> owners = 1;
  kerf::Bvh bvh;
};

struct kerf_scene {
  kerf_scene() = default;
  kerf_scene(const kerf_scene&) = delete;
  kerf_scene& operator=(const kerf_scene&) = delete;
  ~kerf_scene() {
    for (const kerf_instance& instance : instances) {
      kerf_bvh_release(instance.object);
      kerf_scene_release(instance.scene);
    }
  }

  mutable std::atomic<std::size_t> owners = 1;
  std::vector<kerf_instance> instances;  // what was given, for `kerf_scene_get_instance`
  kerf::Scene scene;
};

namespace {

// Values of C lie in memory as those of C++ do.
template <class C, class Cpp>
inline constexpr bool same_layout =
    sizeof(C) == sizeof(Cpp) && std::is_trivially_copyable_v<C>&& std::is_trivially_copyable_v<
                                    Cpp>&& std::is_standard_layout_v<C>&& std::is_standard_layout_v<Cpp>;
static_assert(same_layout<kerf_ray, kerf::Ray> && offsetof(kerf_ray, t_min) == offsetof(kerf::Ray, t_min));
static_assert(same_layout<kerf_hit, kerf::Hit> &&
              offsetof(kerf_hit, primitive) == offsetof(kerf::Hit, primitive) &&
              offsetof(kerf_hit, mesh) == offsetof(kerf::Hit, mesh));
static_assert(same_layout<kerf_surface_point, kerf::SurfacePoint> &&
              offsetof(kerf_surface_point, distance) == offsetof(kerf::SurfacePoint, distance) &&
              offsetof(kerf_surface_point, mesh) == offsetof(kerf::SurfacePoint, mesh));
static_assert(same_layout<kerf_primitive_id, kerf::PrimitiveId> &&
              offsetof(kerf_primitive_id, mesh) == offsetof(kerf::PrimitiveId, mesh));
static_assert(same_layout<kerf_scene_hit, kerf::SceneHit> &&
              offsetof(kerf_scene_hit, primitive) == offsetof(kerf::SceneHit, primitive) &&
              offsetof(kerf_scene_hit, instance) == offsetof(kerf::SceneHit, instance));
static_assert(same_layout<kerf_scene_point, kerf::ScenePoint> &&
              offsetof(kerf_scene_point, distance) == offsetof(kerf::ScenePoint, distance) &&
              offsetof(kerf_scene_point, instance) == offsetof(kerf::ScenePoint, instance));
static_assert(same_layout<kerf_scene_primitive_id, kerf::ScenePrimitiveId> &&
              offsetof(kerf_scene_primitive_id, mesh) == offsetof(kerf::ScenePrimitiveId, mesh) &&
              offsetof(kerf_scene_primitive_id, instance) == offsetof(kerf::ScenePrimitiveId, instance));
static_assert(same_layout<kerf_scene_touching_pair, kerf::SceneTouchingPair> &&
              offsetof(kerf_scene_touching_pair, second) == offsetof(kerf::SceneTouchingPair, second));
static_assert(same_layout<kerf_touching_pair, kerf::TouchingPair>);
static_assert(same_layout<kerf_triangle, kerf::Triangle> && same_layout<kerf_box, kerf::Box3f> &&
              same_layout<kerf_transform, kerf::Transform>);
static_assert(sizeof(kerf::Side) == 1 && static_cast<int>(kerf::Side::outside) == KERF_OUTSIDE &&
              static_cast<int>(kerf::Side::on) == KERF_ON &&
              static_cast<int>(kerf::Side::inside) == KERF_INSIDE);
static_assert(static_cast<int>(kerf::Builder::evh) == KERF_EVH &&
              static_cast<int>(kerf::NonFinite::skip) == KERF_SKIP);
static_assert(kerf::Error::invalid_argument + 1 == KERF_INVALID_ARGUMENT &&
              kerf::Error::bad_format + 1 == KERF_BAD_FORMAT);

// Fixed memory: an error must be told when memory has run out.
thread_local char last_error[512] = "";

kerf_status fail(kerf_status status, const char* sentence) noexcept {
  std::strncpy(last_error, sentence, sizeof last_error - 1);
  return status;
}

[[noreturn]] void refuse(const char* why) {
  throw kerf::Error(kerf::Error::invalid_argument, why);
}

// Calls `work`, which may throw, and says how it ended.
template <class Work>
kerf_status guarded(const Work& work) noexcept {
  try {
    work();
    return KERF_OK;
  } catch (const kerf::Error& error) {
    return fail(static_cast<kerf_status>(error.code() + 1), error.what());
  } catch (const std::bad_alloc&) {
    return fail(KERF_OUT_OF_MEMORY, "out of memory");
  } catch (const std::exception& error) {
    return fail(KERF_INTERNAL, error.what());
  } catch (...) {
    return fail(KERF_INTERNAL, "an unknown exception");
  }
}

template <class... Pointers>
void require(const Pointers*... pointers) {
  const bool all = (static_cast<bool>(pointers) && ...);
  if (!all) refuse("a pointer is null");
}

// A struct that a caller filled in, perhaps one of another version: fields that an older one lacks get their
// defaults, and fields that only a newer one has must not be used.
template <class T>
T read_versioned(const void* from, T defaults, const char* name) {
  std::size_t size = 0;
  std::memcpy(&size, from, sizeof size);
  const auto* bytes = static_cast<const unsigned char*>(from);
  // A struct of any version is a multiple of its alignment: another size would end within a pointer.
  if (size < sizeof size || size > 16 * sizeof(T) || size % alignof(T) != 0)
    throw kerf::Error(kerf::Error::invalid_argument,
                      std::string("struct_size of a ") + name + " is not set: begin with its INIT");
  if (std::any_of(bytes + std::min(size, sizeof(T)), bytes + size, [](unsigned char b) { return b != 0; }))
    throw kerf::Error(kerf::Error::invalid_argument,
                      std::string("a ") + name + " uses fields that this version of kerf does not know");
  std::memcpy(&defaults, from, std::min(size, sizeof(T)));
  return defaults;
}

kerf::Ray to_ray(const kerf_ray& ray) {
  return std::bit_cast<kerf::Ray>(ray);
}
kerf_hit to_c(const kerf::Hit& hit) {
  return std::bit_cast<kerf_hit>(hit);
}
kerf::Vec3f to_point(const float* point) {
  return {point[0], point[1], point[2]};
}
kerf::Transform to_transform(const kerf_transform* transform) {
  return transform == nullptr ? kerf::Transform{} : std::bit_cast<kerf::Transform>(*transform);
}
// Arrays of C as arrays of C++ of the same layout.
template <class Cpp, class C>
Cpp* as(C* values) {
  static_assert(same_layout<std::remove_const_t<C>, std::remove_const_t<Cpp>>);
  return reinterpret_cast<Cpp*>(values);
}

kerf::BatchOptions to_options(const kerf_batch_options* options) {
  if (options == nullptr) return {};
  return {
      .threads =
          read_versioned<kerf_batch_options>(options, KERF_BATCH_OPTIONS_INIT, "kerf_batch_options").threads};
}

kerf::BuildOptions to_options(const kerf_build_options* given) {
  kerf::BuildOptions result;
  if (given == nullptr) return result;
  const auto options =
      read_versioned<kerf_build_options>(given, KERF_BUILD_OPTIONS_INIT, "kerf_build_options");
  if (options.builder < KERF_SBVH || options.builder > KERF_EVH) refuse("there is no such builder");
  if (options.non_finite != KERF_REFUSE && options.non_finite != KERF_SKIP)
    refuse("non_finite is neither KERF_REFUSE nor KERF_SKIP");
  if (options.quality < KERF_FAST || options.quality > KERF_BEST) refuse("there is no such quality");
  result.builder = static_cast<kerf::Builder>(options.builder);
  result.quality = static_cast<kerf::Quality>(options.quality);
  if (options.max_refinement_seconds != 0.0) result.max_refinement_seconds = options.max_refinement_seconds;
  result.alpha = options.alpha;
  result.max_reference_ratio = options.max_reference_ratio;
  result.max_leaf_size = options.max_leaf_size;
  result.threads = options.threads;
  result.non_finite = static_cast<kerf::NonFinite>(options.non_finite);
  result.presplit_references = options.presplit_references;
  if (options.sample_rays == nullptr && options.sample_ray_count != 0)
    refuse("there are no sample_rays where sample_ray_count says that there are");
  result.sample_rays = {as<const kerf::Ray>(options.sample_rays), options.sample_ray_count};
  if (options.progress != nullptr) {
    result.progress = [call = options.progress, context = options.context](float fraction) {
      return call(context, fraction) != 0;
    };
  }
  return result;
}

kerf::TriangleMesh to_mesh(const kerf_mesh& mesh) {
  if ((mesh.vertices == nullptr && mesh.vertex_count != 0) ||
      (mesh.triangles == nullptr && mesh.triangle_count != 0))
    refuse("a mesh has no vertices or no triangles where it says that it has");
  return {.vertices = {mesh.vertices, mesh.vertex_count, mesh.vertex_stride != 0 ? mesh.vertex_stride : 12},
          .triangles = {mesh.triangles, mesh.triangle_count,
                        mesh.triangle_stride != 0 ? mesh.triangle_stride : 12},
          .mask = {mesh.mask}};
}

kerf::DoubleMesh to_mesh(const kerf_double_mesh& mesh) {
  if ((mesh.vertices == nullptr && mesh.vertex_count != 0) ||
      (mesh.triangles == nullptr && mesh.triangle_count != 0))
    refuse("a mesh has no vertices or no triangles where it says that it has");
  if (mesh.index_bits != 32 && mesh.index_bits != 64) refuse("index_bits is neither 32 nor 64");
  const std::size_t packed = 3 * mesh.index_bits / 8,
                    stride = mesh.triangle_stride != 0 ? mesh.triangle_stride : packed;
  kerf::DoubleMesh result{
      .vertices = {mesh.vertices, mesh.vertex_count, mesh.vertex_stride != 0 ? mesh.vertex_stride : 24},
      .triangles = {},
      .mask = {mesh.mask}};
  if (mesh.index_bits == 32) {
    result.triangles =
        kerf::IndexView(static_cast<const std::uint32_t*>(mesh.triangles), mesh.triangle_count, stride);
  } else {
    result.triangles =
        kerf::IndexView(static_cast<const std::uint64_t*>(mesh.triangles), mesh.triangle_count, stride);
  }
  return result;
}

// Calls `take(element)` for each of an array of structs of the caller's version.
template <class C, class Take>
void for_each_versioned(const C* array, std::size_t count, const C& defaults, const char* name,
                        const Take& take) {
  if (count != 0) require(array);
  const auto* at = reinterpret_cast<const unsigned char*>(array);
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t size;
    std::memcpy(&size, at, sizeof size);
    take(read_versioned<C>(at, defaults, name));
    at += size;
  }
}

template <class Mesh, class CMesh>
std::vector<Mesh> to_meshes(const CMesh* meshes, std::size_t count, const CMesh& defaults, const char* name) {
  std::vector<Mesh> views;
  views.reserve(count);
  for_each_versioned(meshes, count, defaults, name,
                     [&](const CMesh& mesh) { views.push_back(to_mesh(mesh)); });
  return views;
}

template <class Mesh, class CMesh>
kerf_status build(const CMesh* meshes, std::size_t count, const CMesh& defaults, const char* name,
                  const kerf_build_options* options, kerf_bvh** bvh) {
  if (bvh == nullptr) return fail(KERF_INVALID_ARGUMENT, "a pointer is null");
  *bvh = nullptr;
  return guarded([&] {
    const std::vector<Mesh> views = to_meshes<Mesh>(meshes, count, defaults, name);
    *bvh = new kerf_bvh(kerf::build(std::span<const Mesh>(views), to_options(options)));
  });
}

// A struct that a call fills in, as far as the caller's version of it reaches.
template <class T>
void write_versioned(const T& filled, T* to, const T& defaults, const char* name) {
  const std::size_t size = read_versioned<T>(to, defaults, name).struct_size;
  std::memcpy(reinterpret_cast<unsigned char*>(to) + sizeof size,
              reinterpret_cast<const unsigned char*>(&filled) + sizeof size,
              std::min(size, sizeof filled) - sizeof size);
}

std::filesystem::path to_path(const char* path) {
  return reinterpret_cast<const char8_t*>(path);
}

template <class Read>
kerf_status open(const char* path, kerf_bvh** bvh, const Read& read) {
  if (bvh == nullptr) return fail(KERF_INVALID_ARGUMENT, "a pointer is null");
  *bvh = nullptr;
  return guarded([&] {
    require(path);
    *bvh = new kerf_bvh(read(to_path(path)));
  });
}

// Gives all that stands in a scene handles: one to each hierarchy and to each scene, however often it stands
// somewhere. They belong to the scenes in which they stand.
class SceneHandles {
 public:
  ~SceneHandles() {
    for (const auto& [of, bvh] : bvhs_) kerf_bvh_release(bvh);
    for (const auto& [of, scene] : scenes_) kerf_scene_release(scene);
  }

  /// A handle that belongs to the caller.
  kerf_scene* of(const kerf::Scene& scene) {
    auto [at, is_new] = scenes_.try_emplace(scene.identity(), nullptr);
    if (!is_new) return kerf_scene_retain(at->second);
    auto made = std::make_unique<kerf_scene>();
    made->scene = scene;
    made->instances.reserve(scene.instances().size());
    for (const kerf::Instance& instance : scene.instances()) {
      kerf_instance given = KERF_INSTANCE_INIT;
      if (instance.scene.instances().empty()) {
        given.object = of(instance.object);
      } else {
        given.scene = of(instance.scene);
      }
      given.transform = std::bit_cast<kerf_transform>(instance.transform);
      given.mask = instance.mask.bits;
      given.number = instance.number;
      made->instances.push_back(given);
    }
    kerf_scene* const handle = made.release();
    scenes_[scene.identity()] = handle;
    return kerf_scene_retain(handle);
  }

 private:
  kerf_bvh* of(const kerf::Bvh& bvh) {
    kerf_bvh*& handle = bvhs_[bvh.identity()];
    if (handle == nullptr) handle = new kerf_bvh(bvh);
    return kerf_bvh_retain(handle);
  }

  std::unordered_map<const void*, kerf_bvh*> bvhs_;
  std::unordered_map<const void*, kerf_scene*> scenes_;
};

template <class Read>
kerf_status open_scene(const char* path, kerf_scene** scene, const Read& read) {
  if (scene == nullptr) return fail(KERF_INVALID_ARGUMENT, "a pointer is null");
  *scene = nullptr;
  return guarded([&] {
    require(path);
    *scene = SceneHandles().of(read(to_path(path)));
  });
}

// What `answers` has goes into the caller's array as far as that reaches.
template <class Answers, class C>
void hand_out(const Answers& answers, C* to, std::size_t capacity, std::size_t* count) {
  using Answer = std::ranges::range_value_t<Answers>;
  static_assert(same_layout<C, Answer>);
  const std::size_t size = std::ranges::size(answers), fit = std::min(size, capacity);
  if (fit != 0) {
    require(to);
    std::memcpy(to, std::ranges::data(answers), fit * sizeof(C));
  }
  if (count != nullptr) *count = size;
}
template <class Answer, class C>
void hand_out(const kerf::Lists<Answer>& lists, std::size_t* offsets, C* to, std::size_t capacity) {
  require(offsets);
  hand_out(lists.items, to, capacity, nullptr);
  std::copy(lists.offsets.begin(), lists.offsets.end(), offsets);
}

template <class To, class From>
kerf::Column<To> to_column(const From& column) {
  return {column.data, column.stride};
}

kerf::RayView to_view(const kerf_rays* given) {
  require(given);
  const auto rays = read_versioned<kerf_rays>(given, kerf_rays{}, "kerf_rays");
  kerf::RayView view;
  view.count = rays.count;
  for (int axis = 0; axis < 3; ++axis) {
    if (rays.count != 0) require(rays.origin[axis].data, rays.direction[axis].data);
    view.origin[axis] = to_column<const float>(rays.origin[axis]);
    view.direction[axis] = to_column<const float>(rays.direction[axis]);
  }
  view.t_min = to_column<const float>(rays.t_min);
  view.t_max = to_column<const float>(rays.t_max);
  view.mask = to_column<const std::uint32_t>(rays.mask);
  return view;
}

kerf::HitView to_view(const kerf_hits* given) {
  require(given);
  const auto hits = read_versioned<kerf_hits>(given, kerf_hits{}, "kerf_hits");
  kerf::HitView view;
  view.count = hits.count;
  view.t = to_column<float>(hits.t);
  view.u = to_column<float>(hits.u);
  view.v = to_column<float>(hits.v);
  view.primitive = to_column<std::uint32_t>(hits.primitive);
  view.mesh = to_column<std::uint32_t>(hits.mesh);
  return view;
}

kerf::PointView to_view(const kerf_points* given) {
  require(given);
  const auto points = read_versioned<kerf_points>(given, kerf_points{}, "kerf_points");
  if (points.count != 0) require(points.data);
  return kerf::PointView(
      kerf::TripleView<float>(points.data, points.count, points.stride != 0 ? points.stride : 12));
}

void write_geometry(const kerf::HitGeometry& found, kerf_hit_geometry& to) {
  std::memcpy(&to.triangle, &found.triangle, sizeof found.triangle);
  std::memcpy(to.normal, &found.normal, sizeof found.normal);
  to.front = found.front;
}

template <class T>
std::span<T> answers(T* data, std::size_t count) {
  if (count != 0) require(data);
  return {data, count};
}

}  // namespace

extern "C" {

const char* kerf_last_error(void) {
  return last_error;
}
uint32_t kerf_version(void) {
  return KERF_VERSION_NUMBER;
}

kerf_status kerf_build(const kerf_mesh* meshes, size_t mesh_count, const kerf_build_options* options,
                       kerf_bvh** bvh) {
  return build<kerf::TriangleMesh, kerf_mesh>(meshes, mesh_count, KERF_MESH_INIT, "kerf_mesh", options, bvh);
}
kerf_status kerf_build_double(const kerf_double_mesh* meshes, size_t mesh_count,
                              const kerf_build_options* options, kerf_bvh** bvh) {
  return build<kerf::DoubleMesh, kerf_double_mesh>(meshes, mesh_count, KERF_DOUBLE_MESH_INIT,
                                                   "kerf_double_mesh", options, bvh);
}

kerf_status kerf_build_memory_bound(size_t triangle_count, const kerf_build_options* options, size_t* bytes) {
  return guarded([&] {
    require(bytes);
    *bytes = kerf::build_memory_bound(triangle_count, to_options(options));
  });
}

kerf_status kerf_refit(kerf_bvh** bvh, const kerf_mesh* meshes, size_t mesh_count,
                       const kerf_build_options* options, kerf_refit_report* report) {
  return guarded([&] {
    require(bvh);
    require(*bvh);
    if (report != nullptr)  // refused before anything has moved
      read_versioned<kerf_refit_report>(report, KERF_REFIT_REPORT_INIT, "kerf_refit_report");
    const auto views =
        to_meshes<kerf::TriangleMesh, kerf_mesh>(meshes, mesh_count, KERF_MESH_INIT, "kerf_mesh");
    // Only the last owner may change what the handle stands for; nobody else is there to become one
    // meanwhile.
    const bool alone = (*bvh)->owners.load(std::memory_order_acquire) == 1;
    std::unique_ptr<kerf_bvh> other;
    if (!alone) other = std::make_unique<kerf_bvh>((*bvh)->bvh);
    const kerf::RefitReport made = kerf::refit(
        alone ? (*bvh)->bvh : other->bvh, std::span<const kerf::TriangleMesh>(views), to_options(options));
    if (!alone) {
      kerf_bvh_release(*bvh);
      *bvh = other.release();
    }
    if (report == nullptr) return;
    const kerf_refit_report filled{.struct_size = 0, .cost_ratio = made.cost_ratio, .rebuilt = made.rebuilt};
    write_versioned<kerf_refit_report>(filled, report, KERF_REFIT_REPORT_INIT, "kerf_refit_report");
  });
}

kerf_bvh* kerf_bvh_retain(const kerf_bvh* bvh) {
  if (bvh != nullptr) bvh->owners.fetch_add(1, std::memory_order_relaxed);
  return const_cast<kerf_bvh*>(bvh);
}
void kerf_bvh_release(const kerf_bvh* bvh) {
  if (bvh != nullptr && bvh->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete bvh;
}

kerf_status kerf_save(const kerf_bvh* bvh, const char* path) {
  return guarded([&] {
    require(bvh, path);
    bvh->bvh.save(std::filesystem::path(reinterpret_cast<const char8_t*>(path)));
  });
}
kerf_status kerf_load(const char* path, kerf_bvh** bvh) {
  return open(path, bvh, [](const std::filesystem::path& file) { return kerf::Bvh::load(file); });
}
kerf_status kerf_map(const char* path, kerf_bvh** bvh) {
  return open(path, bvh, [](const std::filesystem::path& file) { return kerf::Bvh::map(file); });
}

kerf_status kerf_get_statistics(const kerf_bvh* bvh, kerf_statistics* statistics) {
  return guarded([&] {
    require(bvh, statistics);
    const kerf::BvhStatistics& all = bvh->bvh.statistics();
    const kerf_statistics filled{.struct_size = 0,
                                 .triangles = all.triangles,
                                 .degenerate_triangles = all.degenerate_triangles,
                                 .non_finite_triangles = all.non_finite_triangles,
                                 .degenerate_by_rounding = all.degenerate_by_rounding,
                                 .references = all.references,
                                 .nodes = all.nodes,
                                 .bytes = all.bytes,
                                 .build_peak_bytes = all.build_peak_bytes,
                                 .build_seconds = all.build_seconds};
    write_versioned<kerf_statistics>(filled, statistics, KERF_STATISTICS_INIT, "kerf_statistics");
  });
}

kerf_status kerf_get_mesh_statistics(const kerf_bvh* bvh, kerf_mesh_statistics* statistics, size_t capacity,
                                     size_t* count) {
  static_assert(same_layout<kerf_mesh_statistics, kerf::MeshStatistics>);
  return guarded([&] {
    require(bvh, count);
    hand_out(bvh->bvh.mesh_statistics(), statistics, capacity, count);
  });
}

kerf_box kerf_bounds(const kerf_bvh* bvh) {
  return std::bit_cast<kerf_box>(bvh->bvh.bounds());
}

void kerf_origin(const kerf_bvh* bvh, double origin[3]) {
  const kerf::Vec3d at = bvh->bvh.origin();
  origin[0] = at.x, origin[1] = at.y, origin[2] = at.z;
}
void kerf_to_local(const kerf_bvh* bvh, const double point[3], float local[3]) {
  const kerf::Vec3f at = bvh->bvh.to_local(kerf::Vec3d{point[0], point[1], point[2]});
  local[0] = at.x, local[1] = at.y, local[2] = at.z;
}
void kerf_from_local(const kerf_bvh* bvh, const float local[3], double point[3]) {
  const kerf::Vec3d at = bvh->bvh.from_local(to_point(local));
  point[0] = at.x, point[1] = at.y, point[2] = at.z;
}

int kerf_intersect(const kerf_bvh* bvh, const kerf_ray* ray, kerf_hit* hit) {
  return bvh->bvh.intersect(*as<const kerf::Ray>(ray), *as<kerf::Hit>(hit));
}
int kerf_occluded(const kerf_bvh* bvh, const kerf_ray* ray) {
  return bvh->bvh.occluded(*as<const kerf::Ray>(ray));
}

kerf_status kerf_intersect_filtered(const kerf_bvh* bvh, const kerf_ray* ray, uint32_t mask,
                                    kerf_filter filter, void* context, kerf_hit* hit) {
  return guarded([&] {
    require(bvh, ray, hit);
    const kerf::Mask bits{mask};
    const std::optional<kerf::Hit> found =
        filter == nullptr ? bvh->bvh.intersect(to_ray(*ray), bits)
                          : bvh->bvh.intersect(to_ray(*ray), bits, [&](const kerf::Hit& candidate) {
                              const kerf_hit asked = to_c(candidate);
                              return filter(context, &asked) != 0;
                            });
    *hit = to_c(found.value_or(kerf::Hit{}));
  });
}
kerf_status kerf_occluded_filtered(const kerf_bvh* bvh, const kerf_ray* ray, uint32_t mask,
                                   kerf_filter filter, void* context, int* occluded) {
  return guarded([&] {
    require(bvh, ray, occluded);
    const kerf::Mask bits{mask};
    *occluded = filter == nullptr ? bvh->bvh.occluded(to_ray(*ray), bits)
                                  : bvh->bvh.occluded(to_ray(*ray), bits, [&](const kerf::Hit& candidate) {
                                      const kerf_hit asked = to_c(candidate);
                                      return filter(context, &asked) != 0;
                                    });
  });
}

kerf_status kerf_all_hits(const kerf_bvh* bvh, const kerf_ray* ray, kerf_hit* hits, size_t capacity,
                          size_t* count) {
  return guarded([&] {
    require(bvh, ray, count);
    if (capacity != 0) require(hits);
    *count = bvh->bvh.all_hits(to_ray(*ray), std::span(as<kerf::Hit>(hits), capacity));
  });
}
kerf_status kerf_visit_hits(const kerf_bvh* bvh, const kerf_ray* ray, kerf_filter visit, void* context) {
  return guarded([&] {
    require(bvh, ray);
    if (visit == nullptr) refuse("a pointer is null");
    bvh->bvh.all_hits(to_ray(*ray), [&](const kerf::Hit& hit) {
      const kerf_hit visited = to_c(hit);
      return visit(context, &visited) != 0;
    });
  });
}
kerf_status kerf_count_hits(const kerf_bvh* bvh, const kerf_ray* ray, size_t* count) {
  return guarded([&] {
    require(bvh, ray, count);
    *count = bvh->bvh.count_hits(to_ray(*ray));
  });
}

kerf_status kerf_contains(const kerf_bvh* bvh, const float point[3], int* inside) {
  return guarded([&] {
    require(bvh, point, inside);
    *inside = bvh->bvh.contains(to_point(point));
  });
}
kerf_status kerf_get_side(const kerf_bvh* bvh, const float point[3], kerf_side* side) {
  return guarded([&] {
    require(bvh, point, side);
    *side = static_cast<kerf_side>(bvh->bvh.side(to_point(point)));
  });
}
kerf_status kerf_closest_point(const kerf_bvh* bvh, const float point[3], float max_distance,
                               kerf_surface_point* closest) {
  return guarded([&] {
    require(bvh, point, closest);
    const kerf::SurfacePoint found =
        bvh->bvh.closest_point(to_point(point), max_distance).value_or(kerf::SurfacePoint{});
    std::memcpy(closest, &found, sizeof found);
  });
}
kerf_status kerf_signed_distance(const kerf_bvh* bvh, const float point[3], float* distance) {
  return guarded([&] {
    require(bvh, point, distance);
    *distance = bvh->bvh.signed_distance(to_point(point));
  });
}

kerf_status kerf_nearest(const kerf_bvh* bvh, const float point[3], size_t wanted, float max_distance,
                         kerf_surface_point* nearest, size_t capacity, size_t* count) {
  return guarded([&] {
    require(bvh, point, count);
    hand_out(bvh->bvh.nearest(to_point(point), wanted, max_distance), nearest, capacity, count);
  });
}
kerf_status kerf_within(const kerf_bvh* bvh, const float point[3], float radius, kerf_surface_point* points,
                        size_t capacity, size_t* count) {
  return guarded([&] {
    require(bvh, point, count);
    hand_out(bvh->bvh.within(to_point(point), radius), points, capacity, count);
  });
}
kerf_status kerf_triangles_in(const kerf_bvh* bvh, const kerf_box* box, kerf_primitive_id* ids,
                              size_t capacity, size_t* count) {
  return guarded([&] {
    require(bvh, box, count);
    hand_out(bvh->bvh.triangles_in(*as<const kerf::Box3f>(box)), ids, capacity, count);
  });
}

kerf_status kerf_touches(const kerf_bvh* bvh, const kerf_bvh* other, const kerf_transform* transform,
                         int* touch) {
  return guarded([&] {
    require(bvh, other, touch);
    *touch = bvh->bvh.touches(other->bvh, to_transform(transform));
  });
}
kerf_status kerf_touching_pairs(const kerf_bvh* bvh, const kerf_bvh* other, const kerf_transform* transform,
                                kerf_touching_pair* pairs, size_t capacity, size_t* count) {
  return guarded([&] {
    require(bvh, other, count);
    hand_out(bvh->bvh.touching_pairs(other->bvh, to_transform(transform)), pairs, capacity, count);
  });
}

kerf_status kerf_get_triangle(const kerf_bvh* bvh, kerf_primitive_id id, kerf_triangle* triangle,
                              int* found) {
  return guarded([&] {
    require(bvh, triangle, found);
    const std::optional<kerf::Triangle> corners =
        bvh->bvh.triangle({.primitive = id.primitive, .mesh = id.mesh});
    *found = corners.has_value();
    if (corners) std::memcpy(triangle, &*corners, sizeof *triangle);
  });
}
kerf_status kerf_get_geometry(const kerf_bvh* bvh, const kerf_ray* ray, const kerf_hit* hit,
                              kerf_hit_geometry* geometry) {
  return guarded([&] {
    require(bvh, ray, hit, geometry);
    write_geometry(bvh->bvh.geometry(to_ray(*ray), *as<const kerf::Hit>(hit)), *geometry);
  });
}

kerf_rays kerf_rays_of(const kerf_ray* rays, size_t count) {
  kerf_rays view{};
  view.struct_size = sizeof view;
  if (rays == nullptr) return view;
  view.count = count;
  constexpr ptrdiff_t stride = sizeof(kerf_ray);
  for (int axis = 0; axis < 3; ++axis) {
    view.origin[axis] = {&rays->origin[axis], stride};
    view.direction[axis] = {&rays->direction[axis], stride};
  }
  view.t_min = {&rays->t_min, stride};
  view.t_max = {&rays->t_max, stride};
  return view;
}
kerf_hits kerf_hits_of(kerf_hit* hits, size_t count) {
  kerf_hits view{};
  view.struct_size = sizeof view;
  if (hits == nullptr) return view;
  view.count = count;
  constexpr ptrdiff_t stride = sizeof(kerf_hit);
  view.t = {&hits->t, stride};
  view.u = {&hits->u, stride};
  view.v = {&hits->v, stride};
  view.primitive = {&hits->primitive, stride};
  view.mesh = {&hits->mesh, stride};
  return view;
}
kerf_points kerf_points_of(const float* points, size_t count) {
  return {sizeof(kerf_points), points, points == nullptr ? 0 : count, 0};
}

kerf_status kerf_intersect_many(const kerf_bvh* bvh, const kerf_rays* rays, const kerf_hits* hits,
                                const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    bvh->bvh.intersect(to_view(rays), to_view(hits), to_options(options));
  });
}
kerf_status kerf_occluded_many(const kerf_bvh* bvh, const kerf_rays* rays, uint8_t* occluded,
                               const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    const kerf::RayView view = to_view(rays);
    bvh->bvh.occluded(view, answers(occluded, view.count), to_options(options));
  });
}
kerf_status kerf_intersect_many_filtered(const kerf_bvh* bvh, const kerf_rays* rays,
                                         kerf_filter_of_many filter, void* context, const kerf_hits* hits,
                                         const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    if (filter == nullptr) refuse("a pointer is null");
    bvh->bvh.intersect(
        to_view(rays), to_view(hits),
        [&](std::size_t ray, const kerf::Hit& hit) {
          const kerf_hit asked = to_c(hit);
          return filter(context, ray, &asked) != 0;
        },
        to_options(options));
  });
}
kerf_status kerf_occluded_many_filtered(const kerf_bvh* bvh, const kerf_rays* rays,
                                        kerf_filter_of_many filter, void* context, uint8_t* occluded,
                                        const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    if (filter == nullptr) refuse("a pointer is null");
    const kerf::RayView view = to_view(rays);
    bvh->bvh.occluded(
        view, answers(occluded, view.count),
        [&](std::size_t ray, const kerf::Hit& hit) {
          const kerf_hit asked = to_c(hit);
          return filter(context, ray, &asked) != 0;
        },
        to_options(options));
  });
}

kerf_status kerf_count_hits_many(const kerf_bvh* bvh, const kerf_rays* rays, uint32_t* counts,
                                 const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    const kerf::RayView view = to_view(rays);
    bvh->bvh.count_hits(view, answers(counts, view.count), to_options(options));
  });
}
kerf_status kerf_all_hits_many(const kerf_bvh* bvh, const kerf_rays* rays, const size_t* offsets,
                               kerf_hit* hits, size_t capacity, const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh, offsets);
    const kerf::RayView view = to_view(rays);
    bvh->bvh.all_hits(view, std::span(offsets, view.count + 1), answers(as<kerf::Hit>(hits), capacity),
                      to_options(options));
  });
}

kerf_status kerf_contains_many(const kerf_bvh* bvh, const kerf_points* points, uint8_t* inside,
                               const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    const kerf::PointView view = to_view(points);
    bvh->bvh.contains(view, answers(inside, view.size()), to_options(options));
  });
}
kerf_status kerf_side_many(const kerf_bvh* bvh, const kerf_points* points, uint8_t* sides,
                           const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    const kerf::PointView view = to_view(points);
    const std::span<uint8_t> bytes = answers(sides, view.size());
    bvh->bvh.side(view, std::span(reinterpret_cast<kerf::Side*>(bytes.data()), bytes.size()),
                  to_options(options));
  });
}
kerf_status kerf_closest_point_many(const kerf_bvh* bvh, const kerf_points* points, float max_distance,
                                    kerf_surface_point* closest, const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    const kerf::PointView view = to_view(points);
    bvh->bvh.closest_point(view, answers(as<kerf::SurfacePoint>(closest), view.size()), max_distance,
                           to_options(options));
  });
}
kerf_status kerf_signed_distance_many(const kerf_bvh* bvh, const kerf_points* points, float* distances,
                                      const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    const kerf::PointView view = to_view(points);
    bvh->bvh.signed_distance(view, answers(distances, view.size()), to_options(options));
  });
}

kerf_status kerf_nearest_many(const kerf_bvh* bvh, const kerf_points* points, size_t wanted,
                              float max_distance, size_t* offsets, kerf_surface_point* nearest,
                              size_t capacity, const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    hand_out(bvh->bvh.nearest(to_view(points), wanted, max_distance, to_options(options)), offsets, nearest,
             capacity);
  });
}
kerf_status kerf_within_many(const kerf_bvh* bvh, const kerf_points* points, float radius, size_t* offsets,
                             kerf_surface_point* found, size_t capacity, const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    hand_out(bvh->bvh.within(to_view(points), radius, to_options(options)), offsets, found, capacity);
  });
}
kerf_status kerf_triangles_in_many(const kerf_bvh* bvh, const kerf_box* boxes, size_t count, size_t* offsets,
                                   kerf_primitive_id* ids, size_t capacity,
                                   const kerf_batch_options* options) {
  return guarded([&] {
    require(bvh);
    hand_out(bvh->bvh.triangles_in(answers(as<const kerf::Box3f>(boxes), count), to_options(options)),
             offsets, ids, capacity);
  });
}

kerf_status kerf_run_on(const kerf_thread_pool* given, void (*work)(void*), void* context) {
  return guarded([&] {
    require(given);
    const auto pool = read_versioned<kerf_thread_pool>(given, KERF_THREAD_POOL_INIT, "kerf_thread_pool");
    if (pool.threads == nullptr || pool.start == nullptr || work == nullptr) refuse("a function is null");
    kerf::run_on(
        {.threads = [&pool] { return pool.threads(pool.context); },
         .start =
             [&pool](std::function<void()> task) {
               auto held = std::make_unique<std::function<void()>>(std::move(task));
               const auto call = [](void* data) {
                 const std::unique_ptr<std::function<void()>> mine(static_cast<std::function<void()>*>(data));
                 (*mine)();
               };
               if (pool.start(pool.context, call, held.get()) == 0) throw std::bad_alloc();
               held.release();
             }},
        [&] { work(context); });
  });
}

kerf_status kerf_build_scene(const kerf_instance* instances, size_t instance_count,
                             const kerf_build_options* options, kerf_scene** scene) {
  if (scene == nullptr) return fail(KERF_INVALID_ARGUMENT, "a pointer is null");
  *scene = nullptr;
  return guarded([&] {
    auto made = std::make_unique<kerf_scene>();
    std::vector<kerf::Instance> all;
    all.reserve(instance_count);
    made->instances.reserve(instance_count);
    for_each_versioned<kerf_instance>(instances, instance_count, KERF_INSTANCE_INIT, "kerf_instance",
                                      [&](const kerf_instance& given) {
                                        if ((given.object == nullptr) == (given.scene == nullptr))
                                          refuse("an instance needs an object or a scene, and not both");
                                        kerf::Instance instance;
                                        if (given.object != nullptr) instance.object = given.object->bvh;
                                        if (given.scene != nullptr) instance.scene = given.scene->scene;
                                        instance.transform = to_transform(&given.transform);
                                        instance.mask = {given.mask};
                                        instance.number = given.number;
                                        all.push_back(std::move(instance));
                                        kerf_bvh_retain(given.object);
                                        kerf_scene_retain(given.scene);
                                        made->instances.push_back(given);
                                      });
    made->scene = kerf::build(std::span<const kerf::Instance>(all), to_options(options));
    *scene = made.release();
  });
}

kerf_status kerf_scene_save(const kerf_scene* scene, const char* path) {
  return guarded([&] {
    require(scene, path);
    scene->scene.save(to_path(path));
  });
}
kerf_status kerf_scene_load(const char* path, kerf_scene** scene) {
  return open_scene(path, scene, [](const std::filesystem::path& file) { return kerf::Scene::load(file); });
}
kerf_status kerf_scene_map(const char* path, kerf_scene** scene) {
  return open_scene(path, scene, [](const std::filesystem::path& file) { return kerf::Scene::map(file); });
}

kerf_scene* kerf_scene_retain(const kerf_scene* scene) {
  if (scene != nullptr) scene->owners.fetch_add(1, std::memory_order_relaxed);
  return const_cast<kerf_scene*>(scene);
}
void kerf_scene_release(const kerf_scene* scene) {
  if (scene != nullptr && scene->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete scene;
}

uint32_t kerf_scene_instance_count(const kerf_scene* scene) {
  return scene->scene.instance_count();
}
kerf_status kerf_scene_path(const kerf_scene* scene, uint32_t instance, uint32_t* path, size_t capacity,
                            size_t* count) {
  return guarded([&] {
    require(scene, count);
    hand_out(scene->scene.path(instance), path, capacity, count);
  });
}
kerf_status kerf_scene_get_instance(const kerf_scene* scene, size_t place, kerf_instance* instance) {
  return guarded([&] {
    require(scene, instance);
    if (place >= scene->instances.size()) refuse("there is no instance of that number");
    write_versioned<kerf_instance>(scene->instances[place], instance, KERF_INSTANCE_INIT, "kerf_instance");
  });
}
kerf_box kerf_scene_bounds(const kerf_scene* scene) {
  return std::bit_cast<kerf_box>(scene->scene.bounds());
}
size_t kerf_scene_bytes(const kerf_scene* scene) {
  return scene->scene.bytes();
}

int kerf_scene_intersect(const kerf_scene* scene, const kerf_ray* ray, kerf_scene_hit* hit) {
  const std::optional<kerf::SceneHit> found = scene->scene.intersect(*as<const kerf::Ray>(ray));
  *hit = std::bit_cast<kerf_scene_hit>(found.value_or(kerf::SceneHit{}));
  return found.has_value();
}
int kerf_scene_occluded(const kerf_scene* scene, const kerf_ray* ray) {
  return scene->scene.occluded(*as<const kerf::Ray>(ray));
}
kerf_status kerf_scene_intersect_masked(const kerf_scene* scene, const kerf_ray* ray, uint32_t mask,
                                        kerf_scene_hit* hit) {
  return guarded([&] {
    require(scene, ray, hit);
    const kerf::SceneHit found =
        scene->scene.intersect(to_ray(*ray), kerf::Mask{mask}).value_or(kerf::SceneHit{});
    *hit = std::bit_cast<kerf_scene_hit>(found);
  });
}
kerf_status kerf_scene_occluded_masked(const kerf_scene* scene, const kerf_ray* ray, uint32_t mask,
                                       int* occluded) {
  return guarded([&] {
    require(scene, ray, occluded);
    *occluded = scene->scene.occluded(to_ray(*ray), kerf::Mask{mask});
  });
}

kerf_status kerf_scene_intersect_filtered(const kerf_scene* scene, const kerf_ray* ray, uint32_t mask,
                                          kerf_scene_filter filter, void* context, kerf_scene_hit* hit) {
  if (filter == nullptr) return kerf_scene_intersect_masked(scene, ray, mask, hit);
  return guarded([&] {
    require(scene, ray, hit);
    const auto found =
        scene->scene.intersect(to_ray(*ray), kerf::Mask{mask}, [&](const kerf::SceneHit& candidate) {
          const auto asked = std::bit_cast<kerf_scene_hit>(candidate);
          return filter(context, &asked) != 0;
        });
    *hit = std::bit_cast<kerf_scene_hit>(found.value_or(kerf::SceneHit{}));
  });
}
kerf_status kerf_scene_occluded_filtered(const kerf_scene* scene, const kerf_ray* ray, uint32_t mask,
                                         kerf_scene_filter filter, void* context, int* occluded) {
  if (filter == nullptr) return kerf_scene_occluded_masked(scene, ray, mask, occluded);
  return guarded([&] {
    require(scene, ray, occluded);
    *occluded = scene->scene.occluded(to_ray(*ray), kerf::Mask{mask}, [&](const kerf::SceneHit& candidate) {
      const auto asked = std::bit_cast<kerf_scene_hit>(candidate);
      return filter(context, &asked) != 0;
    });
  });
}

kerf_status kerf_scene_all_hits(const kerf_scene* scene, const kerf_ray* ray, kerf_scene_hit* hits,
                                size_t capacity, size_t* count) {
  return guarded([&] {
    require(scene, ray, count);
    if (capacity != 0) require(hits);
    std::size_t size = 0;
    scene->scene.all_hits(to_ray(*ray), [&](const kerf::SceneHit& hit) {
      if (size < capacity) hits[size] = std::bit_cast<kerf_scene_hit>(hit);
      ++size;
    });
    *count = size;
  });
}
kerf_status kerf_scene_count_hits(const kerf_scene* scene, const kerf_ray* ray, size_t* count) {
  return guarded([&] {
    require(scene, ray, count);
    *count = scene->scene.count_hits(to_ray(*ray));
  });
}
kerf_status kerf_scene_contains(const kerf_scene* scene, const float point[3], int* inside) {
  return guarded([&] {
    require(scene, point, inside);
    *inside = scene->scene.contains(to_point(point));
  });
}
kerf_status kerf_scene_get_side(const kerf_scene* scene, const float point[3], kerf_side* side) {
  return guarded([&] {
    require(scene, point, side);
    *side = static_cast<kerf_side>(scene->scene.side(to_point(point)));
  });
}
kerf_status kerf_scene_closest_point(const kerf_scene* scene, const float point[3], float max_distance,
                                     kerf_scene_point* closest) {
  return guarded([&] {
    require(scene, point, closest);
    const kerf::ScenePoint found =
        scene->scene.closest_point(to_point(point), max_distance).value_or(kerf::ScenePoint{});
    std::memcpy(closest, &found, sizeof found);
  });
}
kerf_status kerf_scene_signed_distance(const kerf_scene* scene, const float point[3], float* distance) {
  return guarded([&] {
    require(scene, point, distance);
    *distance = scene->scene.signed_distance(to_point(point));
  });
}
kerf_status kerf_scene_nearest(const kerf_scene* scene, const float point[3], size_t wanted,
                               float max_distance, kerf_scene_point* nearest, size_t capacity,
                               size_t* count) {
  return guarded([&] {
    require(scene, point, count);
    hand_out(scene->scene.nearest(to_point(point), wanted, max_distance), nearest, capacity, count);
  });
}
kerf_status kerf_scene_within(const kerf_scene* scene, const float point[3], float radius,
                              kerf_scene_point* points, size_t capacity, size_t* count) {
  return guarded([&] {
    require(scene, point, count);
    hand_out(scene->scene.within(to_point(point), radius), points, capacity, count);
  });
}
kerf_status kerf_scene_triangles_in(const kerf_scene* scene, const kerf_box* box,
                                    kerf_scene_primitive_id* ids, size_t capacity, size_t* count) {
  return guarded([&] {
    require(scene, box, count);
    hand_out(scene->scene.triangles_in(std::bit_cast<kerf::Box3f>(*box)), ids, capacity, count);
  });
}
kerf_status kerf_scene_get_triangle(const kerf_scene* scene, kerf_scene_primitive_id id,
                                    kerf_triangle* triangle, int* found) {
  return guarded([&] {
    require(scene, triangle, found);
    const std::optional<kerf::Triangle> corners =
        scene->scene.triangle(std::bit_cast<kerf::ScenePrimitiveId>(id));
    *found = corners.has_value();
    if (corners) std::memcpy(triangle, &*corners, sizeof *triangle);
  });
}
kerf_status kerf_scene_get_geometry(const kerf_scene* scene, const kerf_ray* ray, const kerf_scene_hit* hit,
                                    kerf_hit_geometry* geometry) {
  return guarded([&] {
    require(scene, ray, hit, geometry);
    write_geometry(scene->scene.geometry(to_ray(*ray), *as<const kerf::SceneHit>(hit)), *geometry);
  });
}
kerf_status kerf_scene_touching_pairs(const kerf_scene* scene, const kerf_scene* other,
                                      const kerf_transform* transform, kerf_scene_touching_pair* pairs,
                                      size_t capacity, size_t* count) {
  return guarded([&] {
    require(scene, count);
    if (other == nullptr && transform != nullptr) refuse("a transform is given for no other scene");
    hand_out(other == nullptr ? scene->scene.touching_pairs()
                              : scene->scene.touching_pairs(other->scene, to_transform(transform)),
             pairs, capacity, count);
  });
}
kerf_status kerf_scene_touches(const kerf_scene* scene, const kerf_scene* other,
                               const kerf_transform* transform, int* touch) {
  return guarded([&] {
    require(scene, other, touch);
    *touch = scene->scene.touches(other->scene, to_transform(transform));
  });
}

kerf_status kerf_scene_intersect_many(const kerf_scene* scene, const kerf_rays* rays, kerf_scene_hit* hits,
                                      const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    const kerf::RayView view = to_view(rays);
    scene->scene.intersect(view, answers(as<kerf::SceneHit>(hits), view.count), to_options(options));
  });
}
kerf_status kerf_scene_occluded_many(const kerf_scene* scene, const kerf_rays* rays, uint8_t* occluded,
                                     const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    const kerf::RayView view = to_view(rays);
    scene->scene.occluded(view, answers(occluded, view.count), to_options(options));
  });
}
kerf_status kerf_scene_intersect_many_filtered(const kerf_scene* scene, const kerf_rays* rays,
                                               kerf_scene_filter_of_many filter, void* context,
                                               kerf_scene_hit* hits, const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    if (filter == nullptr) refuse("a pointer is null");
    const kerf::RayView view = to_view(rays);
    scene->scene.intersect(
        view, answers(as<kerf::SceneHit>(hits), view.count),
        [&](std::size_t ray, const kerf::SceneHit& hit) {
          const auto asked = std::bit_cast<kerf_scene_hit>(hit);
          return filter(context, ray, &asked) != 0;
        },
        to_options(options));
  });
}
kerf_status kerf_scene_occluded_many_filtered(const kerf_scene* scene, const kerf_rays* rays,
                                              kerf_scene_filter_of_many filter, void* context,
                                              uint8_t* occluded, const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    if (filter == nullptr) refuse("a pointer is null");
    const kerf::RayView view = to_view(rays);
    scene->scene.occluded(
        view, answers(occluded, view.count),
        [&](std::size_t ray, const kerf::SceneHit& hit) {
          const auto asked = std::bit_cast<kerf_scene_hit>(hit);
          return filter(context, ray, &asked) != 0;
        },
        to_options(options));
  });
}
kerf_status kerf_scene_count_hits_many(const kerf_scene* scene, const kerf_rays* rays, uint32_t* counts,
                                       const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    const kerf::RayView view = to_view(rays);
    scene->scene.count_hits(view, answers(counts, view.count), to_options(options));
  });
}
kerf_status kerf_scene_all_hits_many(const kerf_scene* scene, const kerf_rays* rays, size_t* offsets,
                                     kerf_scene_hit* hits, size_t capacity,
                                     const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    hand_out(scene->scene.all_hits(to_view(rays), to_options(options)), offsets, hits, capacity);
  });
}
kerf_status kerf_scene_contains_many(const kerf_scene* scene, const kerf_points* points, uint8_t* inside,
                                     const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    const kerf::PointView view = to_view(points);
    scene->scene.contains(view, answers(inside, view.size()), to_options(options));
  });
}
kerf_status kerf_scene_side_many(const kerf_scene* scene, const kerf_points* points, uint8_t* sides,
                                 const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    const kerf::PointView view = to_view(points);
    const std::span<uint8_t> bytes = answers(sides, view.size());
    scene->scene.side(view, std::span(reinterpret_cast<kerf::Side*>(bytes.data()), bytes.size()),
                      to_options(options));
  });
}
kerf_status kerf_scene_closest_point_many(const kerf_scene* scene, const kerf_points* points,
                                          float max_distance, kerf_scene_point* closest,
                                          const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    const kerf::PointView view = to_view(points);
    scene->scene.closest_point(view, answers(as<kerf::ScenePoint>(closest), view.size()), max_distance,
                               to_options(options));
  });
}
kerf_status kerf_scene_signed_distance_many(const kerf_scene* scene, const kerf_points* points,
                                            float* distances, const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    const kerf::PointView view = to_view(points);
    scene->scene.signed_distance(view, answers(distances, view.size()), to_options(options));
  });
}
kerf_status kerf_scene_nearest_many(const kerf_scene* scene, const kerf_points* points, size_t wanted,
                                    float max_distance, size_t* offsets, kerf_scene_point* nearest,
                                    size_t capacity, const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    hand_out(scene->scene.nearest(to_view(points), wanted, max_distance, to_options(options)), offsets,
             nearest, capacity);
  });
}
kerf_status kerf_scene_within_many(const kerf_scene* scene, const kerf_points* points, float radius,
                                   size_t* offsets, kerf_scene_point* found, size_t capacity,
                                   const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    hand_out(scene->scene.within(to_view(points), radius, to_options(options)), offsets, found, capacity);
  });
}
kerf_status kerf_scene_triangles_in_many(const kerf_scene* scene, const kerf_box* boxes, size_t count,
                                         size_t* offsets, kerf_scene_primitive_id* ids, size_t capacity,
                                         const kerf_batch_options* options) {
  return guarded([&] {
    require(scene);
    hand_out(scene->scene.triangles_in(answers(as<const kerf::Box3f>(boxes), count), to_options(options)),
             offsets, ids, capacity);
  });
}

}  // extern "C"
