#include "cuda_device.hpp"

#include <algorithm>
#include <span>

#include <cuda_runtime_api.h>
#include <kerf/cuda/bvh.hpp>

#include "../src/content.hpp"
#include "../src/launch.hpp"
#include "../src/stopwatch.hpp"
#include "wide_kernels.hpp"

namespace kerf::cuda {
namespace {

using workbench::CountedPass;
using workbench::RaySet;

// The rays that are traced, and room for what is found.
struct DeviceRays {
  DeviceArray<Ray> rays;
  DeviceArray<Hit> hits;
  DeviceArray<std::uint8_t> occluded;
  bool any_hit = false;

  std::size_t count() const { return rays.size(); }
};

// What both structures have in common: `Launch` starts their kernels.
template <class Launch>
class Uploaded final : public workbench::DeviceHierarchy {
 public:
  Uploaded(Launch launch, const DeviceRays& rays) : launch_(std::move(launch)), rays_(rays) {}

  std::size_t references() const override { return launch_.references(); }
  std::size_t nodes() const override { return launch_.nodes(); }
  std::size_t bytes() const override { return launch_.bytes(); }

  CountedPass trace_counted() override {
    CountedPass pass{.hits = std::vector<Hit>(rays_.count())};
    if (rays_.count() == 0) return pass;
    check(cudaMemset(rays_.hits.data(), 0xff, rays_.count() * sizeof(Hit)), "clearing hits");
    check(cudaMemset(rays_.occluded.data(), 0xff, rays_.count()), "clearing results");
    const TotalCounters zero;
    const DeviceArray<TotalCounters> totals{std::span<const TotalCounters>(&zero, 1)};
    launch_.counted(rays_.rays.data(), rays_.count(), rays_.any_hit, totals.data());
    trace();
    check(cudaDeviceSynchronize(), "tracing");
    TotalCounters sum;
    totals.copy_to({&sum, 1});
    pass.steps = sum.nodes;
    pass.triangle_tests = sum.triangles;
    if (rays_.any_hit) {
      std::vector<std::uint8_t> occluded(rays_.count());
      rays_.occluded.copy_to(occluded);
      for (std::size_t i = 0; i < occluded.size(); ++i)
        pass.hits[i].primitive = occluded[i] != 0 ? occluded[i] - 1u : invalid_id;
    } else {
      rays_.hits.copy_to(pass.hits);
    }
    pass.hit_count = static_cast<std::size_t>(
        std::count_if(pass.hits.begin(), pass.hits.end(), [](const Hit& hit) { return bool(hit); }));
    return pass;
  }

  double time() override {
    return 1e-3 * stopwatch_.milliseconds([&] { trace(); });
  }

 private:
  void trace() const {
    if (rays_.any_hit)
      launch_.any(rays_.rays.data(), rays_.occluded.data(), rays_.count());
    else
      launch_.closest(rays_.rays.data(), rays_.hits.data(), rays_.count());
  }

  const Launch launch_;
  const DeviceRays& rays_;
  const Stopwatch stopwatch_;
};

class BinaryTree {
 public:
  explicit BinaryTree(const kerf::Tree& tree) : bvh_(tree) {}
  std::size_t references() const { return bvh_.statistics().references; }
  std::size_t nodes() const { return bvh_.statistics().nodes; }
  std::size_t bytes() const { return bvh_.statistics().bytes; }
  void closest(const Ray* rays, Hit* hits, std::size_t count) const { bvh_.intersect(rays, hits, count); }
  void any(const Ray* rays, std::uint8_t* occluded, std::size_t count) const {
    bvh_.occluded(rays, occluded, count);
  }
  void counted(const Ray* rays, std::size_t count, bool any_hit, TotalCounters* totals) const {
    const Bvh::Content& content = *bvh_.content();
    launch_counted({content.nodes.data(), content.triangles.data(), content.bounds.data(),
                    static_cast<std::uint32_t>(content.nodes.size())},
                   rays, count, any_hit, totals, nullptr);
  }

 private:
  Bvh bvh_;
};

class WideTree {
 public:
  explicit WideTree(const kerf::Tree& tree) {
    const EncodedWide encoded = encode_wide(source_of(tree));
    const std::vector<std::uint32_t> firsts = first_triangles_of(tree);
    nodes_ = DeviceArray<CompressedNode>(std::span(encoded.nodes));
    triangles_ = DeviceArray<DeviceTriangle>(std::span(encoded.triangles));
    bounds_ = DeviceArray<SceneBounds>(std::span<const SceneBounds>(&encoded.bounds, 1));
    first_triangles_ = DeviceArray<std::uint32_t>(std::span(firsts));
  }
  std::size_t references() const { return triangles_.size(); }
  std::size_t nodes() const { return nodes_.size(); }
  std::size_t bytes() const {
    return nodes_.size() * sizeof(CompressedNode) + triangles_.size() * sizeof(DeviceTriangle) +
           first_triangles_.size() * sizeof(std::uint32_t) + sizeof(SceneBounds);
  }
  void closest(const Ray* rays, Hit* hits, std::size_t count) const {
    launch_wide_closest(view(),
                        {first_triangles_.data(), static_cast<std::uint32_t>(first_triangles_.size() - 1)},
                        rays, hits, count, nullptr);
  }
  void any(const Ray* rays, std::uint8_t* occluded, std::size_t count) const {
    launch_wide_any(view(), rays, occluded, count, nullptr);
  }
  void counted(const Ray* rays, std::size_t count, bool any_hit, TotalCounters* totals) const {
    launch_wide_counted(view(), rays, count, any_hit, totals, nullptr);
  }

 private:
  WideHierarchy view() const {
    return {nodes_.data(), triangles_.data(), bounds_.data(), static_cast<std::uint32_t>(nodes_.size())};
  }

  DeviceArray<CompressedNode> nodes_;
  DeviceArray<DeviceTriangle> triangles_;
  DeviceArray<SceneBounds> bounds_;
  DeviceArray<std::uint32_t> first_triangles_;
};

class CudaDevice final : public workbench::TracingDevice {
 public:
  CudaDevice() {
    int device = 0;
    check(cudaGetDevice(&device), "looking for a device");
    cudaDeviceProp properties{};
    check(cudaGetDeviceProperties(&properties, device), "asking for the device's name");
    name_ = properties.name;
    check(cudaFree(nullptr), "starting the device");
  }

  std::string name() const override { return name_; }
  std::vector<std::string> structures() const override { return {"binary", "wide"}; }
  std::unique_ptr<workbench::DeviceHierarchy> upload(const kerf::Tree& tree, std::size_t structure) override {
    if (structure == 0) return std::make_unique<Uploaded<BinaryTree>>(BinaryTree(tree), rays_);
    return std::make_unique<Uploaded<WideTree>>(WideTree(tree), rays_);
  }
  void set_rays(const RaySet& set) override {
    rays_.rays = DeviceArray<Ray>(std::span<const Ray>(set.rays));
    rays_.hits = DeviceArray<Hit>(set.rays.size());
    rays_.occluded = DeviceArray<std::uint8_t>(set.rays.size());
    rays_.any_hit = set.any_hit();
  }

 private:
  std::string name_;
  DeviceRays rays_;
};

}  // namespace

std::unique_ptr<workbench::TracingDevice> open_cuda_device() {
  return std::make_unique<CudaDevice>();
}

}  // namespace kerf::cuda
