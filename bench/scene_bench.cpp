// Scenes of many copies: the time to build the top level, its memory, and rays through it, beside Embree's
// instances, all on one thread.
//
//     build/release/bin/scene_bench SCENE...                     (the bunny's file, for example)
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "workbench/bench/peers/flush_denormals.hpp"
#include "workbench/open/load_scene.hpp"
#include "workbench/scene/scene.hpp"

#ifdef KERF_EMBREE_MAJOR
#if KERF_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#endif

namespace {

using workbench::Scene;

template <class Work>
double seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

float uniform(std::mt19937& random, float low, float high) {
  return low + (high - low) * (static_cast<float>(random() >> 8) * 0x1p-24f);
}

// Copies on a cubic grid, each turned and scaled, near enough to overlap a little.
std::vector<kerf::Instance> copies_of(const kerf::Bvh& object, std::size_t count) {
  std::mt19937 random(1);
  const kerf::Box3f box = object.bounds();
  const double extent =
      std::max({box.upper.x - box.lower.x, box.upper.y - box.lower.y, box.upper.z - box.lower.z});
  const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(count))));
  std::vector<kerf::Instance> instances;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = uniform(random, 0, 6.2831853f), scale = uniform(random, 0.6f, 1.2f);
    const double c = scale * std::cos(angle), s = scale * std::sin(angle);
    const double x = static_cast<double>(i % side), y = static_cast<double>(i / side % side),
                 z = static_cast<double>(i / side / side);
    instances.push_back(
        {.object = object,
         .transform = {{{c, 0, s, x * extent}, {0, scale, 0, y * extent}, {-s, 0, c, z * extent}}},
         .number = static_cast<std::uint32_t>(i)});
  }
  return instances;
}

struct Rays {
  std::vector<kerf::Ray> camera, random;
};

Rays make_rays(const kerf::Box3f& box) {
  Rays rays;
  std::mt19937 random(2);
  const kerf::Vec3f from{box.lower.x - 0.5f * (box.upper.x - box.lower.x),
                         box.upper.y + 0.3f * (box.upper.y - box.lower.y),
                         box.lower.z - 0.7f * (box.upper.z - box.lower.z)};
  constexpr int width = 512, height = 384;
  for (int tile = 0; tile < width * height / 64; ++tile) {
    for (int pixel = 0; pixel < 64; ++pixel) {
      const int i = tile % (width / 8) * 8 + pixel % 8, j = tile / (width / 8) * 8 + pixel / 8;
      const float u = static_cast<float>(i) / width, v = static_cast<float>(j) / height;
      const kerf::Vec3f at{box.lower.x + u * (box.upper.x - box.lower.x),
                           box.lower.y + v * (box.upper.y - box.lower.y),
                           box.lower.z + (1 - u) * (box.upper.z - box.lower.z)};
      rays.camera.push_back({.origin = from, .direction = {at.x - from.x, at.y - from.y, at.z - from.z}});
    }
  }
  for (int i = 0; i < 200'000; ++i) {
    const auto point = [&] {
      const float x = uniform(random, box.lower.x, box.upper.x),
                  y = uniform(random, box.lower.y, box.upper.y),
                  z = uniform(random, box.lower.z, box.upper.z);
      return kerf::Vec3f{x, y, z};
    };
    const kerf::Vec3f a = point(), b = point();
    rays.random.push_back({.origin = a, .direction = {b.x - a.x, b.y - a.y, b.z - a.z}});
  }
  return rays;
}

#ifdef KERF_EMBREE_MAJOR
class Embree {
 public:
  Embree(const Scene& mesh, const std::vector<kerf::Instance>& instances) {
    device_ = rtcNewDevice("threads=1");
    rtcSetDeviceMemoryMonitorFunction(
        device_,
        [](void* bytes, ssize_t change, bool) {
          *static_cast<std::atomic<std::ptrdiff_t>*>(bytes) += change;
          return true;
        },
        &bytes_);
    object_ = rtcNewScene(device_);
    rtcSetSceneBuildQuality(object_, RTC_BUILD_QUALITY_HIGH);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices.data(),
                               0, sizeof(kerf::Vec3f), mesh.vertices.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               3 * sizeof(std::uint32_t), mesh.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(object_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(object_);
    object_bytes_ = bytes_;
    build_time_ = seconds([&] {
      scene_ = rtcNewScene(device_);
      rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_MEDIUM);
      for (const kerf::Instance& instance : instances) {
        const RTCGeometry copy = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(copy, object_);
        float rows[12];
        for (int i = 0; i < 12; ++i) rows[i] = static_cast<float>(instance.transform.rows[i / 4][i % 4]);
        rtcSetGeometryTransform(copy, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
        rtcCommitGeometry(copy);
        rtcAttachGeometry(scene_, copy);
        rtcReleaseGeometry(copy);
      }
      rtcCommitScene(scene_);
    });
  }
  ~Embree() {
    rtcReleaseScene(scene_);
    rtcReleaseScene(object_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  double build_time() const { return build_time_; }
  std::ptrdiff_t bytes() const { return bytes_; }
  std::ptrdiff_t object_bytes() const { return object_bytes_; }

  double mrays_per_second(const std::vector<kerf::Ray>& rays, std::size_t& hits) const {
    const workbench::FlushDenormals flush;
#if KERF_EMBREE_MAJOR >= 4
    RTCIntersectArguments context;
    rtcInitIntersectArguments(&context);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
#endif
    hits = 0;
    const double time = seconds([&] {
      for (const kerf::Ray& ray : rays) {
        RTCRayHit query{};
        query.ray.org_x = ray.origin.x, query.ray.org_y = ray.origin.y, query.ray.org_z = ray.origin.z;
        query.ray.dir_x = ray.direction.x, query.ray.dir_y = ray.direction.y,
        query.ray.dir_z = ray.direction.z;
        query.ray.tfar = ray.t_max;
        query.ray.mask = 0xffffffffu;
        query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if KERF_EMBREE_MAJOR >= 4
        rtcIntersect1(scene_, &query, &context);
#else
        rtcIntersect1(scene_, &context, &query);
#endif
        hits += query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
      }
    });
    return static_cast<double>(rays.size()) / time / 1e6;
  }

 private:
  std::atomic<std::ptrdiff_t> bytes_{0};
  std::ptrdiff_t object_bytes_ = 0;
  RTCDevice device_;
  RTCScene object_, scene_;
  double build_time_ = 0;
};
#else
class Embree {
 public:
  Embree(const Scene&, const std::vector<kerf::Instance>&) {}
  double build_time() const { return 0; }
  std::ptrdiff_t bytes() const { return 0; }
  std::ptrdiff_t object_bytes() const { return 0; }
  double mrays_per_second(const std::vector<kerf::Ray>&, std::size_t&) const { return 0; }
};
#endif

void run(const std::string& spec) {
  Scene mesh = workbench::load_scene(spec);
  const kerf::Bvh object = kerf::build(mesh.mesh());
  mesh.vertices.emplace_back();  // Embree reads four floats at a time
  for (const std::size_t count : {std::size_t{100}, std::size_t{10'000}, std::size_t{100'000}}) {
    const std::vector<kerf::Instance> instances = copies_of(object, count);
    kerf::Scene scene;
    double build_time = 1e9;
    for (int round = 0; round < 3; ++round)
      build_time = std::min(build_time, seconds([&] { scene = kerf::build(instances, {.threads = 1}); }));
    double on_all = 1e9;
    for (int round = 0; round < 3; ++round)
      on_all = std::min(on_all, seconds([&] { scene = kerf::build(instances); }));
    const Embree embree(mesh, instances);
    fmt::print("{}, {} copies\n  build: kerf {:.2f} ms ({:.2f} ms on all threads), embree {:.2f} ms\n", spec,
               count, 1e3 * build_time, 1e3 * on_all, 1e3 * embree.build_time());
    fmt::print("  MB: kerf {:.2f} + object {:.2f}, embree {:.2f} + object {:.2f}\n",
               static_cast<double>(scene.bytes()) / 1e6, static_cast<double>(object.statistics().bytes) / 1e6,
               static_cast<double>(embree.bytes() - embree.object_bytes()) / 1e6,
               static_cast<double>(embree.object_bytes()) / 1e6);
    const Rays rays = make_rays(scene.bounds());
    const auto trace = [&](const char* name, const std::vector<kerf::Ray>& set) {
      double ours = 0, peer = 0;
      std::size_t hits = 0, peer_hits = 0;
      for (int round = 0; round < 3; ++round) {
        hits = 0;
        const double time = seconds([&] {
          for (const kerf::Ray& ray : set) hits += scene.intersect(ray).has_value();
        });
        ours = std::max(ours, static_cast<double>(set.size()) / time / 1e6);
        peer = std::max(peer, embree.mrays_per_second(set, peer_hits));
      }
      fmt::print("  {}: kerf {:.3f} Mrays/s, embree {:.3f} ({:.2f}); hits {} and {}\n", name, ours, peer,
                 ours / peer, hits, peer_hits);
    };
    trace("camera", rays.camera);
    trace("random", rays.random);
  }
}

}  // namespace

int main(int count, char** arguments) {
  for (int i = 1; i < count; ++i) run(arguments[i]);
}
