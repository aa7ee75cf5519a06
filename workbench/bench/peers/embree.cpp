#include "workbench/bench/peers/embree.hpp"

#if KERF_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <kerf/error.hpp>

#include "workbench/bench/peers/flush_denormals.hpp"
#include "workbench/bench/peers/made_rays.hpp"
#include "workbench/bench/peers/ray_blocks.hpp"

namespace workbench {
namespace {

// The bytes that Embree reported to its memory monitor.
struct Memory {
  std::atomic<std::ptrdiff_t> now{0};
  std::atomic<std::ptrdiff_t> peak{0};

  static bool monitor(void* self, ssize_t bytes, bool) {
    Memory& memory = *static_cast<Memory*>(self);
    const std::ptrdiff_t now = memory.now.fetch_add(bytes) + bytes;
    std::ptrdiff_t peak = memory.peak.load();
    while (now > peak && !memory.peak.compare_exchange_weak(peak, now)) {
    }
    return true;
  }
};

// From the narrowest to the widest, as "isa" of a device's options names them (Embree's manual,
// rtcNewDevice).
#if defined(__x86_64__) || defined(__i386__)
constexpr std::string_view isas[] = {"sse2", "sse4.2", "avx", "avx2", "avx512"};
#else
constexpr std::string_view isas[] = {"native"};  // stands for the option left out: there is no choice
#endif

std::string device_options(unsigned threads, std::string_view isa) {
  const std::string options = "threads=" + std::to_string(threads);
  return isa == "native" ? options : options + ",isa=" + std::string(isa);
}

// Embree makes no device for an instruction set that the machine lacks.
bool is_supported(std::string_view isa) {
  const RTCDevice device = rtcNewDevice(device_options(1, isa).c_str());
  if (device == nullptr) return false;
  rtcReleaseDevice(device);
  return true;
}

struct Device {
  Memory memory;
  RTCDevice handle;

  Device(unsigned threads, const std::string& isa) {
    handle = rtcNewDevice(device_options(threads, isa).c_str());
    if (handle == nullptr) {
      throw kerf::Error(kerf::Error::invalid_argument, "Embree cannot make a device for " + isa);
    }
    rtcSetDeviceMemoryMonitorFunction(handle, Memory::monitor, &memory);
  }
  ~Device() { rtcReleaseDevice(handle); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
};

struct Quality {
  RTCBuildQuality build;
  RTCSceneFlags flags;
  RTCBuildQuality geometry = RTC_BUILD_QUALITY_MEDIUM;  ///< in dynamic scenes: of each mesh's own structure
};

struct Scene {
  std::shared_ptr<Device> device;
  RTCScene handle;
  std::vector<std::unique_ptr<const Scene>> objects;  ///< that stand at places in it

  Scene(std::shared_ptr<Device> on, const kerf::TriangleMesh& mesh, Quality quality)
      : Scene(std::move(on), quality) {
    RTCGeometry geometry = rtcNewGeometry(device->handle, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, quality.geometry);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices.data(),
                               0, mesh.vertices.stride(), mesh.vertices.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               mesh.triangles.stride(), mesh.triangles.size());
    attach(geometry);
    commit();
  }

  Scene(std::shared_ptr<Device> on, const PlacedMeshes& placed, Quality quality)
      : Scene(std::move(on), quality) {
    for (const PlacedMeshes::Mesh& mesh : placed.meshes)
      objects.push_back(std::make_unique<const Scene>(device, mesh.mesh(), quality));
    for (const auto& [mesh, transform] : placed.places) {
      RTCGeometry geometry = rtcNewGeometry(device->handle, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(geometry, objects[mesh]->handle);
      float rows[12];
      std::transform(&transform.rows[0][0], &transform.rows[0][0] + 12, rows,
                     [](double number) { return static_cast<float>(number); });
      rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
      attach(geometry);
    }
    commit();
  }

  ~Scene() { rtcReleaseScene(handle); }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  /// The vertices of its one mesh have moved.
  void move() {
    RTCGeometry geometry = rtcGetGeometry(handle, 0);
    rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry);
    commit();
  }

 private:
  Scene(std::shared_ptr<Device> on, Quality quality)
      : device(std::move(on)), handle(rtcNewScene(device->handle)) {
    rtcSetSceneBuildQuality(handle, quality.build);
    rtcSetSceneFlags(handle, quality.flags);
  }

  void attach(RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(handle, geometry);
    rtcReleaseGeometry(geometry);
  }

  void commit() {
    rtcCommitScene(handle);
    if (rtcGetDeviceError(device->handle) != RTC_ERROR_NONE)
      throw kerf::Error(kerf::Error::invalid_argument, "Embree cannot build this scene");
  }
};

// Embree 3 and 4 differ here in one point only: how a query is given its flags.
#if KERF_EMBREE_MAJOR >= 4
struct Query {
  RTCIntersectArguments intersect;
  RTCOccludedArguments occluded;

  explicit Query(RTCRayQueryFlags flags) {
    rtcInitIntersectArguments(&intersect);
    rtcInitOccludedArguments(&occluded);
    intersect.flags = occluded.flags = flags;
  }
};
constexpr RTCRayQueryFlags coherent = RTC_RAY_QUERY_FLAG_COHERENT, incoherent = RTC_RAY_QUERY_FLAG_INCOHERENT;

void intersect1(const Scene& scene, Query& query, RTCRayHit& ray) {
  rtcIntersect1(scene.handle, &ray, &query.intersect);
}
void occluded1(const Scene& scene, Query& query, RTCRay& ray) {
  rtcOccluded1(scene.handle, &ray, &query.occluded);
}
void intersect16(const int* valid, const Scene& scene, Query& query, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene.handle, &rays, &query.intersect);
}
void occluded16(const int* valid, const Scene& scene, Query& query, RTCRay16& rays) {
  rtcOccluded16(valid, scene.handle, &rays, &query.occluded);
}
#else
struct Query {
  RTCIntersectContext context;

  explicit Query(RTCIntersectContextFlags flags) {
    rtcInitIntersectContext(&context);
    context.flags = flags;
  }
};
constexpr RTCIntersectContextFlags coherent = RTC_INTERSECT_CONTEXT_FLAG_COHERENT,
                                   incoherent = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;

void intersect1(const Scene& scene, Query& query, RTCRayHit& ray) {
  rtcIntersect1(scene.handle, &query.context, &ray);
}
void occluded1(const Scene& scene, Query& query, RTCRay& ray) {
  rtcOccluded1(scene.handle, &query.context, &ray);
}
void intersect16(const int* valid, const Scene& scene, Query& query, RTCRayHit16& rays) {
  rtcIntersect16(valid, scene.handle, &query.context, &rays);
}
void occluded16(const int* valid, const Scene& scene, Query& query, RTCRay16& rays) {
  rtcOccluded16(valid, scene.handle, &query.context, &rays);
}
#endif

// Embree sets tfar of an occluded ray to this.
constexpr float occluded_t = -std::numeric_limits<float>::infinity();

RTCRay to_embree(const kerf::Ray& ray) {
  return {.org_x = ray.origin.x,
          .org_y = ray.origin.y,
          .org_z = ray.origin.z,
          .tnear = ray.t_min,
          .dir_x = ray.direction.x,
          .dir_y = ray.direction.y,
          .dir_z = ray.direction.z,
          .time = 0.0f,
          .tfar = ray.t_max,
          .mask = 0xffffffffu,
          .id = 0,
          .flags = 0};
}

// A ray whose fields other than origin, direction and range are those of every ray; Embree leaves them alone.
RTCRay unmade_ray() {
  return to_embree({});
}

void write(RTCRay& ray, const MadeRay& made, float t_max) {
  write_fields(ray.org_x, ray.org_y, ray.org_z, made.origin);
  write_field(ray.tnear, 0.0f);
  write_fields(ray.dir_x, ray.dir_y, ray.dir_z, made.direction);
  write_field(ray.tfar, t_max);
}

class IntersectMade {
 public:
  explicit IntersectMade(const Scene& scene) : scene_(scene) { ray_.ray = unmade_ray(); }

  std::optional<kerf::Hit> operator()(const MadeRay& made, float t_max) {
    write(ray_.ray, made, t_max);
    ray_.hit.geomID = ray_.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersect1(scene_, query_, ray_);
    const RTCHit& hit = ray_.hit;
    if (hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return kerf::Hit{ray_.ray.tfar, hit.u, hit.v, hit.primID, hit.geomID};
  }

 private:
  const FlushDenormals flush_;
  const Scene& scene_;
  Query query_{incoherent};
  RTCRayHit ray_;
};

class OccludedMade {
 public:
  explicit OccludedMade(const Scene& scene) : scene_(scene), ray_(unmade_ray()) {}

  bool operator()(const MadeRay& made, float t_max) {
    write(ray_, made, t_max);
    occluded1(scene_, query_, ray_);
    return ray_.tfar == occluded_t;
  }

 private:
  const FlushDenormals flush_;
  const Scene& scene_;
  Query query_{incoherent};
  RTCRay ray_;
};

Tracer trace_single(std::shared_ptr<const Scene> scene, std::string engine, unsigned threads) {
  return {.engine = std::move(engine),
          .mode = "single",
          .intersect =
              [scene, threads](std::span<const kerf::Ray> rays, std::span<kerf::Hit> hits) {
                for_ray_blocks(threads, rays.size(), [&](std::size_t begin, std::size_t end) {
                  const FlushDenormals flush;
                  Query query(incoherent);
                  RTCRayHit ray;
                  for (std::size_t i = begin; i < end; ++i) {
                    ray.ray = to_embree(rays[i]);
                    ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
                    intersect1(*scene, query, ray);
                    hits[i] =
                        ray.hit.geomID == RTC_INVALID_GEOMETRY_ID
                            ? kerf::Hit{}
                            : kerf::Hit{ray.ray.tfar, ray.hit.u, ray.hit.v, ray.hit.primID, ray.hit.geomID};
                  }
                });
              },
          .occluded =
              [scene, threads](std::span<const kerf::Ray> rays, std::span<std::uint8_t> results) {
                for_ray_blocks(threads, rays.size(), [&](std::size_t begin, std::size_t end) {
                  const FlushDenormals flush;
                  Query query(incoherent);
                  for (std::size_t i = begin; i < end; ++i) {
                    RTCRay ray = to_embree(rays[i]);
                    occluded1(*scene, query, ray);
                    results[i] = ray.tfar == occluded_t;
                  }
                });
              },
          .intersect_made =
              [scene, threads](const RaySet& set, std::size_t first, std::span<kerf::Hit> hits) {
                for_made_rays(threads, set, first, hits, [&] { return IntersectMade(*scene); });
              },
          .occluded_made =
              [scene, threads](const RaySet& set, std::size_t first, std::span<std::uint8_t> results) {
                for_made_rays(threads, set, first, results, [&] { return OccludedMade(*scene); });
              }};
}

constexpr std::size_t packet_width = 16;

// The rays from `begin` on as a packet. Lanes at or beyond `end` are switched off.
void fill_packet(std::span<const kerf::Ray> rays, std::size_t begin, std::size_t end, int* valid,
                 RTCRay16& packet) {
  for (std::size_t k = 0; k < packet_width; ++k) {
    valid[k] = begin + k < end ? -1 : 0;
    const kerf::Ray& ray = rays[begin + k < end ? begin + k : begin];
    packet.org_x[k] = ray.origin.x;
    packet.org_y[k] = ray.origin.y;
    packet.org_z[k] = ray.origin.z;
    packet.tnear[k] = ray.t_min;
    packet.dir_x[k] = ray.direction.x;
    packet.dir_y[k] = ray.direction.y;
    packet.dir_z[k] = ray.direction.z;
    packet.time[k] = 0.0f;
    packet.tfar[k] = ray.t_max;
    packet.mask[k] = 0xffffffffu;
    packet.id[k] = 0;
    packet.flags[k] = 0;
  }
}

// All packets are declared coherent. Camera rays are; for others the flag only shifts the point from which
// Embree continues ray by ray.
Tracer trace_packets(std::shared_ptr<const Scene> scene, std::string engine, unsigned threads) {
  return {.engine = std::move(engine),
          .mode = "packet",
          .intersect =
              [scene, threads](std::span<const kerf::Ray> rays, std::span<kerf::Hit> hits) {
                for_ray_blocks(threads, rays.size(), [&](std::size_t begin, std::size_t end) {
                  const FlushDenormals flush;
                  Query query(coherent);
                  alignas(64) int valid[packet_width];
                  alignas(64) RTCRayHit16 packet;
                  for (std::size_t i = begin; i < end; i += packet_width) {
                    fill_packet(rays, i, end, valid, packet.ray);
                    for (std::size_t k = 0; k < packet_width; ++k) {
                      packet.hit.geomID[k] = packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
                    }
                    intersect16(valid, *scene, query, packet);
                    for (std::size_t k = 0; k < packet_width && i + k < end; ++k) {
                      hits[i + k] = packet.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID
                                        ? kerf::Hit{}
                                        : kerf::Hit{packet.ray.tfar[k], packet.hit.u[k], packet.hit.v[k],
                                                    packet.hit.primID[k], packet.hit.geomID[k]};
                    }
                  }
                });
              },
          .occluded =
              [scene, threads](std::span<const kerf::Ray> rays, std::span<std::uint8_t> results) {
                for_ray_blocks(threads, rays.size(), [&](std::size_t begin, std::size_t end) {
                  const FlushDenormals flush;
                  Query query(coherent);
                  alignas(64) int valid[packet_width];
                  alignas(64) RTCRay16 packet;
                  for (std::size_t i = begin; i < end; i += packet_width) {
                    fill_packet(rays, i, end, valid, packet);
                    occluded16(valid, *scene, query, packet);
                    for (std::size_t k = 0; k < packet_width && i + k < end; ++k) {
                      results[i + k] = packet.tfar[k] == occluded_t;
                    }
                  }
                });
              }};
}

Engine embree_engine(std::string name, unsigned threads, const std::string& isa, Quality quality,
                     bool packets) {
  const auto device = std::make_shared<Device>(threads, isa);
  const auto build = [=](const auto& shape) {  // a mesh, or several at places
    const std::ptrdiff_t before = device->memory.now;
    device->memory.peak = before;
    const auto scene = std::make_shared<const Scene>(device, shape, quality);
    Traceable traceable{.bytes = static_cast<std::size_t>(device->memory.now - before),
                        .build_peak_bytes = static_cast<std::size_t>(device->memory.peak - before),
                        .tracers = {}};
    traceable.tracers.push_back(trace_single(scene, name, threads));
    // Over instances Embree 3.13.5 does not come back from coherent packets that ask for any hit.
    if (packets && scene->objects.empty())
      traceable.tracers.push_back(trace_packets(scene, name + "-packet", threads));
    return traceable;
  };
  return {.name = name,
          .version = "Embree " RTC_VERSION_STRING,
          .isa = isa,
          .build = build,
          .build_placed = build};
}

// Its manual's way for a mesh that changes in every frame: a dynamic scene of low quality, whose geometry is
// refitted; or a new build, of low quality or of the next better one.
std::vector<Mover> embree_movers(unsigned threads, const std::string& isa, const kerf::TriangleMesh& mesh) {
  struct Way {
    const char* engine;
    const char* motion;
    Quality quality;
  };
  const auto dynamic = [](RTCBuildQuality geometry) {
    return Quality{RTC_BUILD_QUALITY_LOW, RTC_SCENE_FLAG_DYNAMIC, geometry};
  };
  const Way ways[] = {{"embree", "refit", dynamic(RTC_BUILD_QUALITY_REFIT)},
                      {"embree-low", "rebuild", dynamic(RTC_BUILD_QUALITY_LOW)},
                      {"embree-medium", "rebuild", dynamic(RTC_BUILD_QUALITY_MEDIUM)}};
  std::vector<Mover> movers;
  for (const Way& way : ways) {
    const auto device = std::make_shared<Device>(threads, isa);
    const auto scene = std::make_shared<Scene>(device, mesh, way.quality);
    movers.push_back({.engine = way.engine,
                      .motion = way.motion,
                      .next_frame = [scene] { scene->move(); },
                      .tracer = [=] { return trace_single(scene, way.engine, threads); }});
  }
  return movers;
}

}  // namespace

std::vector<std::string> embree_isas() {
  std::vector<std::string> supported;
  for (const std::string_view isa : isas) {
    if (is_supported(isa)) supported.emplace_back(isa);
  }
  return supported;
}

std::vector<Engine> embree_engines(unsigned threads, const std::string& isa) {
  const Quality high{RTC_BUILD_QUALITY_HIGH, RTC_SCENE_FLAG_NONE};
  const Quality robust{RTC_BUILD_QUALITY_HIGH, RTC_SCENE_FLAG_ROBUST};
  const Quality medium{RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_NONE};
  std::vector<Engine> engines{embree_engine("embree-high", threads, isa, high, true),
                              embree_engine("embree-high-robust", threads, isa, robust, false),
                              embree_engine("embree-medium", threads, isa, medium, false)};
  // Once for all of them: what they differ in is the build.
  engines.front().movers = [threads, isa](const kerf::TriangleMesh& mesh) {
    return embree_movers(threads, isa, mesh);
  };
  return engines;
}

}  // namespace workbench
