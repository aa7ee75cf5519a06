// Meshes that bend: the time of a refit and of rays after it, beside a new build and beside Embree's refit,
// all on one thread.
//
//     build/release/bin/refit_bench SCENE...                     (the bunny's file, for example)
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <kerf/kerf.hpp>

#include "workbench/bench/peers/flush_denormals.hpp"
#include "workbench/open/load_scene.hpp"
#include "workbench/rays/rays.hpp"
#include "workbench/scene/scene.hpp"
#include "workbench/scene/viewpoints.hpp"

#ifdef KERF_EMBREE_MAJOR
#if KERF_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#endif

namespace {

using workbench::Scene;

constexpr int rounds = 7;

template <class Work>
double seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// A wave along the longest axis of the scene: vertices move across it by up to `amount` of the extent.
void bend(const Scene& rest, double amount, double phase, std::vector<kerf::Vec3f>& vertices) {
  kerf::Box3f box;
  for (const kerf::Vec3f& v : rest.vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = std::min(box.lower[axis], v[axis]);
      box.upper[axis] = std::max(box.upper[axis], v[axis]);
    }
  }
  int along = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (box.upper[axis] - box.lower[axis] > box.upper[along] - box.lower[along]) along = axis;
  const double extent = box.upper[along] - box.lower[along];
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const kerf::Vec3f& v = rest.vertices[i];
    const double angle = 6.283185307179586 * (v[along] - box.lower[along]) / extent + phase;
    vertices[i] = v;
    vertices[i][(along + 1) % 3] += static_cast<float>(amount * extent * std::sin(angle));
    vertices[i][(along + 2) % 3] += static_cast<float>(0.5 * amount * extent * std::cos(angle));
  }
}

double mrays_per_second(const kerf::Bvh& bvh, const std::vector<kerf::Ray>& rays) {
  std::size_t hits = 0;
  const double time = seconds([&] {
    for (const kerf::Ray& ray : rays) hits += bvh.intersect(ray).has_value();
  });
  return static_cast<double>(rays.size()) / time / 1e6 + 0.0 * static_cast<double>(hits);
}

#ifdef KERF_EMBREE_MAJOR
class Embree {
 public:
  Embree(const Scene& rest, std::vector<kerf::Vec3f>& vertices) : device_(rtcNewDevice("threads=1")) {
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_LOW);
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
    rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices.data(), 0,
                               sizeof(kerf::Vec3f), vertices.size() - 1);
    rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, rest.triangles.data(),
                               0, 3 * sizeof(std::uint32_t), rest.triangles.size());
    rtcCommitGeometry(geometry_);
    rtcAttachGeometry(scene_, geometry_);
    rtcCommitScene(scene_);
  }
  ~Embree() {
    rtcReleaseGeometry(geometry_);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  void refit() {
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
  }

  double mrays_per_second(const std::vector<kerf::Ray>& rays) const {
    const workbench::FlushDenormals flush;
#if KERF_EMBREE_MAJOR >= 4
    RTCIntersectArguments context;
    rtcInitIntersectArguments(&context);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
#endif
    const double time = seconds([&] {
      for (const kerf::Ray& ray : rays) {
        RTCRayHit query{};
        query.ray.org_x = ray.origin.x, query.ray.org_y = ray.origin.y, query.ray.org_z = ray.origin.z;
        query.ray.dir_x = ray.direction.x, query.ray.dir_y = ray.direction.y,
        query.ray.dir_z = ray.direction.z;
        query.ray.tnear = ray.t_min;
        query.ray.tfar = ray.t_max;
        query.ray.mask = 0xffffffffu;
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if KERF_EMBREE_MAJOR >= 4
        rtcIntersect1(scene_, &query, &context);
#else
        rtcIntersect1(scene_, &context, &query);
#endif
      }
    });
    return static_cast<double>(rays.size()) / time / 1e6;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
  RTCGeometry geometry_;
};
#else
class Embree {
 public:
  Embree(const Scene&, std::vector<kerf::Vec3f>&) {}
  void refit() {}
  double mrays_per_second(const std::vector<kerf::Ray>&) const { return 0.0; }
};
#endif

void run(const std::string& spec) {
  const Scene rest = workbench::load_scene(spec);
  std::vector<kerf::Vec3f> vertices = rest.vertices;
  const auto mesh = [&] { return kerf::TriangleMesh{.vertices = vertices, .triangles = rest.triangles}; };
  const kerf::BuildOptions one_thread{.threads = 1};
  kerf::Bvh bvh = kerf::build(mesh(), one_thread);
  vertices.emplace_back();  // Embree reads four floats at a time
  Embree embree(rest, vertices);
  vertices.pop_back();
  fmt::print("{}: {} triangles, {} references\n", spec, rest.triangles.size(), bvh.statistics().references);
  fmt::print("  bend   refit  build  embree's refit   cost   primary: refit build embree   diffuse: ...\n");
  kerf::refit(bvh, mesh(), one_thread);  // the first finds the pieces
  for (const double amount : {0.01, 0.03, 0.1, 0.3}) {
    double refit_time = 1e9, build_time = 1e9, embree_time = 1e9;
    kerf::RefitReport report;
    kerf::Bvh built;
    for (int round = 0; round < rounds; ++round) {
      bend(rest, amount, 0.7 * round, vertices);
      refit_time = std::min(refit_time, seconds([&] { report = kerf::refit(bvh, mesh(), one_thread); }));
      embree_time = std::min(embree_time, seconds([&] { embree.refit(); }));
      if (round % 3 == 0)
        build_time = std::min(build_time, seconds([&] { built = kerf::build(mesh(), one_thread); }));
    }
    fmt::print("  {:4.0f} %  {:5.2f}  {:5.1f}  {:5.2f} ms          {:5.3f}", 100 * amount, 1e3 * refit_time,
               1e3 * build_time, 1e3 * embree_time, report.cost_ratio);
    Scene bent = rest;
    bent.vertices = vertices;
    for (const workbench::RayType type : {workbench::RayType::primary, workbench::RayType::diffuse}) {
      const auto rays = workbench::make_rays(bent, built, type).rays;
      double refitted = 0, fresh = 0, peer = 0;
      for (int round = 0; round < 4; ++round) {
        refitted = std::max(refitted, mrays_per_second(bvh, rays));
        fresh = std::max(fresh, mrays_per_second(built, rays));
        peer = std::max(peer, embree.mrays_per_second(rays));
      }
      fmt::print("   {:5.2f} {:5.2f} {:5.2f} ({:.3f} of a build)", refitted, fresh, peer, refitted / fresh);
    }
    fmt::print("\n");
  }
}

}  // namespace

int main(int count, char** arguments) {
  for (int i = 1; i < count; ++i) run(arguments[i]);
}
