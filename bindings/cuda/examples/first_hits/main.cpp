// A mesh that lies on the GPU already: the hierarchy is built there, traced there, and moved there.
#include <array>
#include <cstdio>
#include <vector>

#include <cuda_runtime_api.h>
#include <kerf/cuda/bvh.hpp>

namespace {

// An array of the device; `cudaFree` gives it back at the end of the program.
template <class T>
T* on_device(const std::vector<T>& values) {
  void* memory = nullptr;
  cudaMalloc(&memory, values.size() * sizeof(T));
  cudaMemcpy(memory, values.data(), values.size() * sizeof(T), cudaMemcpyHostToDevice);
  return static_cast<T*>(memory);
}

}  // namespace

int main() try {
  std::vector<kerf::Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  const std::vector<kerf::Ray> rays{{.origin = {0.75f, 0.25f, 2}, .direction = {0, 0, -1}},
                                    {.origin = {7, 7, 2}, .direction = {0, 0, -1}}};
  kerf::Vec3f* device_vertices = on_device(vertices);
  const auto* device_triangles = on_device(triangles);
  const kerf::Ray* device_rays = on_device(rays);
  kerf::Hit* device_hits = on_device(std::vector<kerf::Hit>(rays.size()));

  const kerf::TriangleMesh mesh{.vertices = {device_vertices, vertices.size()},
                                .triangles = {device_triangles, triangles.size()}};
  kerf::cuda::Bvh bvh = kerf::cuda::Bvh::build({&mesh, 1});
  for (int frame = 0; frame < 2; ++frame) {
    bvh.intersect(device_rays, device_hits, rays.size());
    std::vector<kerf::Hit> hits(rays.size());
    cudaMemcpy(hits.data(), device_hits, hits.size() * sizeof(kerf::Hit), cudaMemcpyDeviceToHost);
    for (const kerf::Hit& hit : hits) {
      if (hit)
        std::printf("hit triangle %u at t = %g\n", hit.primitive, hit.t);
      else
        std::printf("missed\n");
    }
    for (kerf::Vec3f& vertex : vertices) vertex.z = 1;
    cudaMemcpy(device_vertices, vertices.data(), vertices.size() * sizeof(kerf::Vec3f),
               cudaMemcpyHostToDevice);
    bvh.refit({&mesh, 1});
  }
} catch (const kerf::cuda::Error& error) {
  std::printf("%s\n", error.what());
  return 1;
}
