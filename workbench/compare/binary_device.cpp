#include "workbench/compare/binary_device.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace workbench {
namespace {

class BinaryHierarchy final : public DeviceHierarchy {
 public:
  BinaryHierarchy(kerf::Tree tree, const RaySet& set) : tree_(std::move(tree)), set_(set) {}

  std::size_t references() const override { return tree_.references().size(); }
  std::size_t nodes() const override { return tree_.nodes().size() / 2; }
  std::size_t bytes() const override { return tree_.nodes().size_bytes() + tree_.references().size_bytes(); }

  CountedPass trace_counted() override {
    CountedPass pass{.hits = std::vector<kerf::Hit>(set_.rays.size())};
    kerf::TraversalCounters counters;
    trace(pass.hits, counters);
    pass.steps = counters.steps;
    pass.triangle_tests = counters.triangle_tests;
    pass.leaf_visits = counters.leaves;
    pass.hit_count = static_cast<std::size_t>(std::count_if(
        pass.hits.begin(), pass.hits.end(), [](const kerf::Hit& hit) { return static_cast<bool>(hit); }));
    return pass;
  }

  double time() override {
    std::vector<kerf::Hit> hits(set_.rays.size());
    kerf::TraversalCounters counters;
    const auto start = std::chrono::steady_clock::now();
    trace(hits, counters);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

 private:
  void trace(std::vector<kerf::Hit>& hits, kerf::TraversalCounters& counters) const {
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (!set_.any_hit()) {
        hits[i] = intersect(tree_, set_.rays[i], counters).value_or(kerf::Hit{});
      } else if (occluded(tree_, set_.rays[i], counters)) {
        hits[i].primitive = 0;
      }
    }
  }

  const kerf::Tree tree_;
  const RaySet& set_;
};

class WideHierarchy final : public DeviceHierarchy {
 public:
  WideHierarchy(const kerf::Tree& tree, const RaySet& set) : bvh_{make_bvh(tree)}, set_(set) {}

  std::size_t references() const override { return bvh_[0].statistics().references; }
  std::size_t nodes() const override { return bvh_[0].statistics().nodes; }
  std::size_t bytes() const override { return bvh_[0].statistics().bytes; }
  CountedPass trace_counted() override { return workbench::trace_counted(bvh_[0], set_, 1); }
  double time() override {
    return time_hierarchies(bvh_, set_, {.rounds = 1, .seconds = 0.0}).front().seconds;
  }

 private:
  const std::vector<kerf::Bvh> bvh_;  // of one
  const RaySet& set_;
};

class BinaryDevice final : public TracingDevice {
 public:
  std::string name() const override { return "the CPU, binary trees one node at a time"; }
  std::vector<std::string> structures() const override { return {"binary", "wide"}; }
  std::unique_ptr<DeviceHierarchy> upload(const kerf::Tree& tree, std::size_t structure) override {
    if (structure == 0) return std::make_unique<BinaryHierarchy>(tree, set_);
    return std::make_unique<WideHierarchy>(tree, set_);
  }
  void set_rays(const RaySet& set) override { set_ = set; }

 private:
  RaySet set_{};
};

}  // namespace

std::unique_ptr<TracingDevice> open_binary_device() {
  return std::make_unique<BinaryDevice>();
}

}  // namespace workbench
