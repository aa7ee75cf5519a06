// Calls of the C interface in any order, with structs of any version, arrays that end where they say, and
// pointers that may be null. Nothing may read or write beyond what it was given, and no call may fail of
// itself.
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include <fuzzer/FuzzedDataProvider.h>
#include <kerf/kerf.h>

namespace {

// A struct as a caller of another version has it: shorter, or longer, in memory that ends with it.
template <class T>
class Versioned {
 public:
  Versioned(FuzzedDataProvider& input, const T& value) {
    const std::size_t size =
        input.ConsumeProbability<float>() < 0.9f
            ? sizeof(T)
            : input.ConsumeIntegralInRange<std::size_t>(sizeof(std::size_t), 2 * sizeof(T));
    bytes_ = std::make_unique<unsigned char[]>(size);
    std::memcpy(bytes_.get(), &value, std::min(size, sizeof(T)));
    if (size > sizeof(T)) bytes_[size - 1] = input.ConsumeIntegral<unsigned char>() & 1;
    std::memcpy(bytes_.get(), &size, sizeof size);
  }
  // NOLINTNEXTLINE: what a caller in C does
  T* get() { return reinterpret_cast<T*>(bytes_.get()); }

 private:
  std::unique_ptr<unsigned char[]> bytes_;
};

float number(FuzzedDataProvider& input) {
  if (input.ConsumeProbability<float>() < 0.9f)
    return static_cast<float>(input.ConsumeIntegralInRange<int>(-4, 4));
  const auto bits = input.ConsumeIntegral<std::uint32_t>();
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

kerf_ray ray(FuzzedDataProvider& input) {
  kerf_ray made;
  for (float& x : made.origin) x = number(input);
  for (float& x : made.direction) x = number(input);
  made.t_min = number(input);
  made.t_max = input.ConsumeBool() ? INFINITY : number(input);
  return made;
}

void expect(kerf_status status, bool made) {
  if (status == KERF_INTERNAL || (status == KERF_OK) != made) std::abort();
  if (status != KERF_OK && kerf_last_error()[0] == '\0') std::abort();
}

struct Mesh {
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles;

  explicit Mesh(FuzzedDataProvider& input) {
    vertices.resize(3 * input.ConsumeIntegralInRange<std::size_t>(1, 12));
    for (float& x : vertices) x = number(input);
    triangles.resize(3 * input.ConsumeIntegralInRange<std::size_t>(0, 20));
    const auto last = static_cast<std::uint32_t>(vertices.size() / 3 - 1);
    const bool wrong = input.ConsumeProbability<float>() > 0.98f;
    for (std::uint32_t& index : triangles)
      index = input.ConsumeIntegralInRange<std::uint32_t>(0, last + wrong);
  }
  kerf_mesh view() const {
    kerf_mesh mesh = KERF_MESH_INIT;
    mesh.vertices = vertices.data();
    mesh.vertex_count = vertices.size() / 3;
    mesh.triangles = triangles.data();
    mesh.triangle_count = triangles.size() / 3;
    return mesh;
  }
};

kerf_build_options options(FuzzedDataProvider& input) {
  kerf_build_options made = KERF_BUILD_OPTIONS_INIT;
  made.builder = input.ConsumeIntegralInRange(-1, 4);
  made.alpha = input.ConsumeBool() ? 0.0f : number(input);
  made.max_leaf_size = input.ConsumeIntegralInRange(0u, 9u);
  made.threads = 1;
  made.non_finite = input.ConsumeIntegralInRange(-1, 2);
  return made;
}

// Lists into an array that ends where `capacity` says.
template <class T, class Call>
void list(FuzzedDataProvider& input, const Call& call) {
  const auto capacity = input.ConsumeIntegralInRange<std::size_t>(0, 5);
  const auto answers = std::make_unique<T[]>(capacity);
  std::size_t count = 0;
  const kerf_status status = call(capacity == 0 ? nullptr : answers.get(), capacity, &count);
  if (status != KERF_OK && status != KERF_INVALID_ARGUMENT) std::abort();
}

void ask(FuzzedDataProvider& input, const kerf_bvh* bvh) {
  const kerf_ray from = ray(input);
  kerf_hit hit;
  const int found = kerf_intersect(bvh, &from, &hit);
  if (found != (hit.primitive != KERF_INVALID_ID) || kerf_occluded(bvh, &from) != found) std::abort();
  if (found) {
    kerf_hit_geometry geometry;
    expect(kerf_get_geometry(bvh, &from, &hit, &geometry), true);
  }
  list<kerf_hit>(input, [&](kerf_hit* to, std::size_t capacity, std::size_t* count) {
    return kerf_all_hits(bvh, &from, to, capacity, count);
  });
  const float* const point = from.origin;
  int inside;
  kerf_surface_point closest;
  expect(kerf_contains(bvh, point, &inside), true);
  expect(kerf_closest_point(bvh, point, number(input), &closest), true);
  list<kerf_surface_point>(input, [&](kerf_surface_point* to, std::size_t capacity, std::size_t* count) {
    return kerf_within(bvh, point, number(input), to, capacity, count);
  });
  list<kerf_touching_pair>(input, [&](kerf_touching_pair* to, std::size_t capacity, std::size_t* count) {
    return kerf_touching_pairs(bvh, bvh, nullptr, to, capacity, count);
  });
  std::array<kerf_ray, 3> rays{from, ray(input), ray(input)};
  const auto hits = std::make_unique<kerf_hit[]>(rays.size());
  Versioned<kerf_rays> view(input, kerf_rays_of(rays.data(), rays.size()));
  Versioned<kerf_hits> to(input, kerf_hits_of(hits.get(), input.ConsumeIntegralInRange<std::size_t>(2, 3)));
  Versioned<kerf_batch_options> one(input, {sizeof(kerf_batch_options), 1});
  if (kerf_intersect_many(bvh, view.get(), to.get(), one.get()) == KERF_INTERNAL) std::abort();
}

void ask(FuzzedDataProvider& input, const kerf_scene* scene) {
  const kerf_ray from = ray(input);
  kerf_scene_hit hit;
  const int found = kerf_scene_intersect(scene, &from, &hit);
  if (found != (hit.instance != KERF_INVALID_ID) || kerf_scene_occluded(scene, &from) != found) std::abort();
  if (found) {
    list<std::uint32_t>(input, [&](std::uint32_t* to, std::size_t capacity, std::size_t* count) {
      return kerf_scene_path(scene, hit.instance, to, capacity, count);
    });
  }
  list<kerf_scene_hit>(input, [&](kerf_scene_hit* to, std::size_t capacity, std::size_t* count) {
    return kerf_scene_all_hits(scene, &from, to, capacity, count);
  });
  int inside;
  kerf_scene_point closest;
  expect(kerf_scene_contains(scene, from.origin, &inside), true);
  expect(kerf_scene_closest_point(scene, from.origin, number(input), &closest), true);
  kerf_side side;
  expect(kerf_scene_get_side(scene, from.origin, &side), true);
  list<kerf_scene_point>(input, [&](kerf_scene_point* to, std::size_t capacity, std::size_t* count) {
    return kerf_scene_nearest(scene, from.origin, input.ConsumeIntegral<std::uint8_t>(), number(input), to,
                              capacity, count);
  });
  list<kerf_scene_point>(input, [&](kerf_scene_point* to, std::size_t capacity, std::size_t* count) {
    return kerf_scene_within(scene, from.origin, number(input), to, capacity, count);
  });
  const kerf_box box = {{from.origin[0], from.origin[1], from.origin[2]},
                        {from.direction[0], from.direction[1], from.direction[2]}};
  list<kerf_scene_primitive_id>(input,
                                [&](kerf_scene_primitive_id* to, std::size_t capacity, std::size_t* count) {
                                  return kerf_scene_triangles_in(scene, &box, to, capacity, count);
                                });
  list<kerf_scene_touching_pair>(
      input, [&](kerf_scene_touching_pair* to, std::size_t capacity, std::size_t* count) {
        return kerf_scene_touching_pairs(scene, nullptr, nullptr, to, capacity, count);
      });
  const auto refuse = [](void*, const kerf_scene_hit*) { return 0; };
  expect(kerf_scene_intersect_filtered(scene, &from, ~0u, refuse, nullptr, &hit), true);
  if (hit.instance != KERF_INVALID_ID) std::abort();
  Versioned<kerf_instance> one(input, kerf_instance KERF_INSTANCE_INIT);
  (void)kerf_scene_get_instance(scene, input.ConsumeIntegralInRange<std::size_t>(0, 3), one.get());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider input(data, size);
  std::vector<kerf_bvh*> hierarchies;
  std::vector<kerf_scene*> scenes;
  for (int step = 0; step < 12 && input.remaining_bytes() != 0; ++step) {
    switch (input.ConsumeIntegralInRange(0, 4)) {
      case 0: {
        const Mesh mesh(input);
        Versioned<kerf_mesh> view(input, mesh.view());
        Versioned<kerf_build_options> how(input, options(input));
        kerf_bvh* made;
        const kerf_status status =
            kerf_build(view.get(), 1, input.ConsumeBool() ? how.get() : nullptr, &made);
        expect(status, made != nullptr);
        if (made != nullptr) hierarchies.push_back(made);
        break;
      }
      case 1: {
        if (hierarchies.empty()) break;
        const Mesh mesh(input);
        Versioned<kerf_mesh> view(input, mesh.view());
        Versioned<kerf_refit_report> report(input, kerf_refit_report KERF_REFIT_REPORT_INIT);
        kerf_bvh*& bvh = hierarchies[input.ConsumeIntegralInRange<std::size_t>(0, hierarchies.size() - 1)];
        if (kerf_refit(&bvh, view.get(), 1, nullptr, report.get()) == KERF_INTERNAL || bvh == nullptr)
          std::abort();
        break;
      }
      case 2: {
        kerf_instance instance = KERF_INSTANCE_INIT;
        if (!hierarchies.empty() && input.ConsumeBool()) instance.object = hierarchies.back();
        if (!scenes.empty() && input.ConsumeBool()) instance.scene = scenes.back();
        for (auto& row : instance.transform.rows)
          for (double& x : row)
            if (input.ConsumeBool()) x = number(input);
        instance.mask = input.ConsumeIntegral<std::uint32_t>();
        Versioned<kerf_instance> view(input, instance);
        kerf_scene* made;
        const kerf_status status = kerf_build_scene(view.get(), 1, nullptr, &made);
        expect(status, made != nullptr);
        if (made != nullptr) scenes.push_back(made);
        break;
      }
      case 3:
        if (!hierarchies.empty()) ask(input, hierarchies.back());
        break;
      default:
        if (!scenes.empty()) ask(input, scenes.back());
    }
  }
  for (const kerf_bvh* bvh : hierarchies) kerf_bvh_release(bvh);
  for (const kerf_scene* scene : scenes) kerf_scene_release(scene);
  return 0;
}
