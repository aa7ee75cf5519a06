#include "bench/embree_points.hpp"

#ifdef KERF_EMBREE_MAJOR

#if KERF_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cmath>
#include <limits>
#include <vector>

#include "math/vec3f.hpp"

namespace bench {
namespace {

using kerf::Vec3f;

// By the regions of a triangle's plane in which its corners, edges and inside are closest (Ericson 2005,
// "Real-Time Collision Detection", 5.1.5), in single precision.
Vec3f closest_on_triangle(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3f ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const float d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
              d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const float va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const float scale = 1 / (va + vb + vc);
  return a + vb * scale * ab + vc * scale * ac;
}

bool consider(RTCPointQueryFunctionArguments* arguments) {
  const auto& scene = *static_cast<const workbench::Scene*>(arguments->userPtr);
  const auto& triangle = scene.triangles[arguments->primID];
  const Vec3f p{arguments->query->x, arguments->query->y, arguments->query->z};
  const Vec3f way = closest_on_triangle(p, scene.vertices[triangle[0]], scene.vertices[triangle[1]],
                                        scene.vertices[triangle[2]]) -
                    p;
  const float distance = std::sqrt(dot(way, way));
  if (!(distance < arguments->query->radius)) return false;
  arguments->query->radius = distance;
  return true;
}

}  // namespace

struct EmbreePoints::State {
  const workbench::Scene& scene;
  std::vector<Vec3f> vertices;  // with one more at the end: Embree reads four floats at a time
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene handle = rtcNewScene(device);

  explicit State(const workbench::Scene& shown)
      : scene(shown), vertices(shown.vertices.begin(), shown.vertices.end()) {
    vertices.emplace_back();
    rtcSetSceneBuildQuality(handle, RTC_BUILD_QUALITY_HIGH);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices.data(), 0,
                               sizeof(Vec3f), scene.vertices.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene.triangles.data(),
                               0, sizeof(scene.triangles[0]), scene.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(handle, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(handle);
  }
  ~State() {
    rtcReleaseScene(handle);
    rtcReleaseDevice(device);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

EmbreePoints::EmbreePoints(const workbench::Scene& scene) : state_(std::make_unique<State>(scene)) {}

float EmbreePoints::distance(const Vec3f& point) const {
  RTCPointQuery query{point.x, point.y, point.z, 0, std::numeric_limits<float>::infinity()};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(state_->handle, &query, &context, consider, const_cast<workbench::Scene*>(&state_->scene));
  return query.radius;
}

}  // namespace bench

#else

namespace bench {

struct EmbreePoints::State {};
EmbreePoints::EmbreePoints(const workbench::Scene&) {}
float EmbreePoints::distance(const kerf::Vec3f&) const {
  return 0;
}

}  // namespace bench

#endif

namespace bench {
EmbreePoints::~EmbreePoints() = default;
}  // namespace bench
