// cuBQL (github.com/NVIDIA/cuBQL): its binary hierarchies, its traversals and its ray-triangle test.
#define CUBQL_GPU_BUILDER_IMPLEMENTATION 1
#include "../src/device_array.hpp"
#include "cuBQL/bvh.h"
#include "cuBQL/queries/triangleData/math/rayTriangleIntersections.h"
#include "cuBQL/traversal/rayQueries.h"
#include "peer.hpp"

namespace kerf::cuda {
namespace {

struct Mesh {
  const cuBQL::vec3f* vertices;
  const cuBQL::vec3i* triangles;
};

__device__ cuBQL::triangle_t<float> corner_points(const Mesh& mesh, std::uint32_t i) {
  const cuBQL::vec3i t = mesh.triangles[i];
  return {mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]};
}

__global__ void make_boxes(Mesh mesh, cuBQL::box3f* boxes, std::uint32_t count) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  const auto t = corner_points(mesh, i);
  boxes[i] = cuBQL::box3f().including(t.a).including(t.b).including(t.c);
}

__device__ cuBQL::ray3f convert(const Ray& ray) {
  return {{ray.origin.x, ray.origin.y, ray.origin.z},
          {ray.direction.x, ray.direction.y, ray.direction.z},
          ray.t_min,
          ray.t_max};
}

__global__ void __launch_bounds__(128)
    trace_closest(cuBQL::bvh3f bvh, Mesh mesh, const Ray* rays, Hit* hits, std::uint32_t count) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  cuBQL::ray3f ray = convert(rays[i]);
  Hit hit;
  const auto per_triangle = [&](std::uint32_t number) -> float {
    cuBQL::RayTriangleIntersection_t<float> found;
    if (found.compute(ray, corner_points(mesh, number))) {
      ray.tMax = found.t;
      hit = {found.t, found.u, found.v, number, 0};
    }
    return ray.tMax;
  };
  cuBQL::shrinkingRayQuery::forEachPrim(per_triangle, bvh, ray);
  hits[i] = hit;
}

__global__ void __launch_bounds__(128)
    trace_any(cuBQL::bvh3f bvh, Mesh mesh, const Ray* rays, std::uint8_t* results, std::uint32_t count) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  const cuBQL::ray3f ray = convert(rays[i]);
  bool hit = false;
  const auto per_triangle = [&](std::uint32_t number) -> int {
    cuBQL::RayTriangleIntersection_t<float> found;
    if (!found.compute(ray, corner_points(mesh, number))) return CUBQL_CONTINUE_TRAVERSAL;
    hit = true;
    return CUBQL_TERMINATE_TRAVERSAL;
  };
  cuBQL::fixedRayQuery::forEachPrim(per_triangle, bvh, ray);
  results[i] = hit;
}

// The mesh on the device, shared by the hierarchies.
struct DeviceMesh {
  DeviceArray<Vec3f> vertices;
  DeviceArray<std::array<std::uint32_t, 3>> triangles;
  DeviceArray<cuBQL::box3f> boxes;
  Mesh view() const {
    return {reinterpret_cast<const cuBQL::vec3f*>(vertices.data()),
            reinterpret_cast<const cuBQL::vec3i*>(triangles.data())};
  }
};

class Cubql final : public Peer {
 public:
  Cubql(std::shared_ptr<const DeviceMesh> mesh, std::string name, cuBQL::BuildConfig config)
      : mesh_(std::move(mesh)), name_(std::move(name)) {
    cudaEvent_t begin, end;
    check(cudaEventCreate(&begin), "making an event");
    check(cudaEventCreate(&end), "making an event");
    for (int round = 0; round < 2; ++round) {  // the first warms up
      if (round != 0) cuBQL::cuda::free(bvh_, 0, memory_);
      check(cudaEventRecord(begin), "recording an event");
      cuBQL::gpuBuilder(bvh_, mesh_->boxes.data(), static_cast<std::uint32_t>(mesh_->boxes.size()), config, 0,
                        memory_);
      check(cudaEventRecord(end), "recording an event");
      check(cudaEventSynchronize(end), "building cuBQL's hierarchy");
    }
    float ms = 0;
    check(cudaEventElapsedTime(&ms, begin, end), "reading a time");
    build_ms_ = ms;
    cudaEventDestroy(begin);
    cudaEventDestroy(end);
  }
  ~Cubql() override { cuBQL::cuda::free(bvh_, 0, memory_); }

  std::string name() const override { return name_; }
  double build_ms() const override { return build_ms_; }
  void closest(const Ray* rays, Hit* hits, std::uint32_t count) const override {
    trace_closest<<<(count + 127) / 128, 128>>>(bvh_, mesh_->view(), rays, hits, count);
    check(cudaGetLastError(), "starting cuBQL's traversal");
  }
  void any(const Ray* rays, std::uint8_t* results, std::uint32_t count) const override {
    trace_any<<<(count + 127) / 128, 128>>>(bvh_, mesh_->view(), rays, results, count);
    check(cudaGetLastError(), "starting cuBQL's traversal");
  }

 private:
  std::shared_ptr<const DeviceMesh> mesh_;
  std::string name_;
  mutable cuBQL::DeviceMemoryResource memory_;
  cuBQL::bvh3f bvh_;
  double build_ms_ = 0;
};

}  // namespace

std::vector<std::unique_ptr<Peer>> make_peers(std::span<const Vec3f> vertices,
                                              std::span<const std::array<std::uint32_t, 3>> triangles) {
  auto mesh = std::make_shared<DeviceMesh>();
  mesh->vertices = DeviceArray<Vec3f>(vertices);
  mesh->triangles = DeviceArray<std::array<std::uint32_t, 3>>(triangles);
  mesh->boxes = DeviceArray<cuBQL::box3f>(triangles.size());
  const auto count = static_cast<std::uint32_t>(triangles.size());
  make_boxes<<<(count + 127) / 128, 128>>>(mesh->view(), mesh->boxes.data(), count);
  check(cudaDeviceSynchronize(), "making boxes for cuBQL");
  std::vector<std::unique_ptr<Peer>> peers;
  const auto add = [&](const char* name, cuBQL::BuildConfig config) {
    peers.push_back(std::make_unique<Cubql>(mesh, name, config));
  };
  cuBQL::BuildConfig median, sah, small_sah;
  sah.enableSAH();
  small_sah.enableSAH();
  small_sah.makeLeafThreshold = 4;
  add("cubql-median", median);
  add("cubql-sah", sah);
  add("cubql-sah-4", small_sah);
  return peers;
}

}  // namespace kerf::cuda
