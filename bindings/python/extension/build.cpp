// Builds and refits, from arrays of vertices and triangles.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <limits>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <kerf/inspect.hpp>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"

namespace kerf::python {
namespace {

/// Rows of three, their numbers beside each other: floats or doubles, 32-bit or 64-bit indices.
using Rows = nb::ndarray<nb::ro, nb::shape<-1, 3>, nb::device::cpu>;

/// Rays as `Ray` holds them, one a row: origin, direction, t_min, t_max.
using RayRows = nb::ndarray<const float, nb::shape<-1, 8>, nb::c_contig, nb::device::cpu>;

std::span<const Ray> rays_of(const RayRows& rows) {
  static_assert(sizeof(Ray) == 8 * sizeof(float));
  return {reinterpret_cast<const Ray*>(rows.data()), rows.shape(0)};
}

template <class Scalar>
TripleView<Scalar> triples_of(const Rows& rows) {
  return {static_cast<const Scalar*>(rows.data()), rows.shape(0),
          static_cast<std::size_t>(stride_in_bytes(rows, 0))};
}

IndexView indices_of(const Rows& rows) {
  if (rows.itemsize() == sizeof(std::uint64_t)) return triples_of<std::uint64_t>(rows);
  return triples_of<std::uint32_t>(rows);
}

/// The meshes, in single precision or in double.
struct Meshes {
  std::vector<TriangleMesh> floats;
  std::vector<DoubleMesh> doubles;
  std::size_t triangles = 0;

  Meshes(const std::vector<Rows>& vertices, const std::vector<Rows>& faces,
         const std::vector<std::uint32_t>& masks) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const Mask mask{masks[i]};
      if (vertices[i].dtype() == nb::dtype<float>()) {
        floats.push_back({triples_of<float>(vertices[i]), triples_of<std::uint32_t>(faces[i]), mask});
      } else {
        doubles.push_back({triples_of<double>(vertices[i]), indices_of(faces[i]), mask});
      }
      triangles += faces[i].shape(0);
    }
  }

  Bvh build(const BuildOptions& options) const {
    return doubles.empty() ? kerf::build(std::span<const TriangleMesh>(floats), options)
                           : kerf::build(std::span<const DoubleMesh>(doubles), options);
  }
};

Builder builder_named(std::string_view name) {
  std::string known;
  for (const BuilderInfo& info : builders()) {
    if (info.name == name) return info.builder;
    known += known.empty() ? "" : ", ";
    known += info.name;
  }
  throw Error(Error::invalid_argument,
              "there is no builder " + std::string(name) + ", but there are " + known);
}

/// A build, or a refit that may become one, on a thread of its own. The thread that asked for it waits, runs
/// what signals ask for, and calls `progress`, which thus runs where Python's programs expect it.
class Build {
 public:
  Build(BuildOptions options, std::function<void(const BuildOptions&)> work) {
    options.progress = [this](float fraction) {
      const std::lock_guard lock(mutex_);
      fraction_ = fraction;
      return !cancelled_;
    };
    thread_ = std::thread([this, options, work = std::move(work)] {
      try {
        work(options);
      } catch (...) {
        failure_ = std::current_exception();
      }
      const std::lock_guard lock(mutex_);
      is_done_ = true;
      done_.notify_one();
    });
  }

  ~Build() { cancel(); }
  Build(const Build&) = delete;
  Build& operator=(const Build&) = delete;

  void wait(const nb::object& progress) {
    constexpr std::chrono::milliseconds between_looks(20);
    float told = -1.0f;
    for (bool is_done = false; !is_done;) {
      float fraction = 0.0f;
      {
        const nb::gil_scoped_release unlocked;
        std::unique_lock lock(mutex_);
        is_done = done_.wait_for(lock, between_looks, [this] { return is_done_; });
        fraction = fraction_;
      }
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      if (!progress.is_none() && fraction > told) {
        told = fraction;
        const nb::object answer = progress(fraction);
        if (answer.is(Py_False)) {
          cancel();
          throw Error(Error::cancelled, "the progress callback cancelled the build");
        }
      }
    }
    thread_.join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void cancel() {
    if (!thread_.joinable()) return;
    {
      const std::lock_guard lock(mutex_);
      cancelled_ = true;
    }
    const nb::gil_scoped_release unlocked;
    thread_.join();
  }

  std::mutex mutex_;
  std::condition_variable done_;
  float fraction_ = 0.0f;
  bool cancelled_ = false;
  bool is_done_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

Quality quality_named(std::string_view name) {
  if (name == "fast") return Quality::fast;
  if (name == "high") return Quality::high;
  if (name == "best") return Quality::best;
  throw nb::value_error("quality must be \"fast\", \"high\" or \"best\"");
}

BuildOptions options_of(std::string_view builder, std::string_view quality, double max_refinement_seconds,
                        float alpha, float max_reference_ratio, unsigned max_leaf_size, unsigned threads,
                        bool skip_non_finite, std::size_t presplit_references,
                        std::span<const Ray> sample_rays) {
  return {.builder = builder_named(builder),
          .quality = quality_named(quality),
          .max_refinement_seconds = max_refinement_seconds,
          .sample_rays = sample_rays,
          .alpha = alpha,
          .max_reference_ratio = max_reference_ratio,
          .max_leaf_size = max_leaf_size,
          .threads = threads,
          .non_finite = skip_non_finite ? NonFinite::skip : NonFinite::refuse,
          .presplit_references = presplit_references};
}

// Up to so many triangles a build ends before anybody could press a key: it needs no thread of its own.
constexpr std::size_t small = 20'000;

// Calls `work` with the options.
template <class Work>
void run(const Meshes& meshes, const BuildOptions& options, const nb::object& progress, const Work& work) {
  if (meshes.triangles <= small && progress.is_none()) {
    unlocked([&] { work(options); });
  } else {
    Build(options, work).wait(progress);
  }
}

Hierarchy* build(const std::vector<Rows>& vertices, const std::vector<Rows>& faces,
                 const std::vector<std::uint32_t>& masks, const std::string& builder,
                 const std::string& quality, double max_refinement_seconds, float alpha,
                 float max_reference_ratio, unsigned max_leaf_size, unsigned threads, bool skip_non_finite,
                 std::size_t presplit_references, const RayRows& sample_rays, const nb::object& progress) {
  const Meshes meshes(vertices, faces, masks);
  Bvh bvh;
  run(meshes,
      options_of(builder, quality, max_refinement_seconds, alpha, max_reference_ratio, max_leaf_size, threads,
                 skip_non_finite, presplit_references, rays_of(sample_rays)),
      progress, [&](const BuildOptions& options) { bvh = meshes.build(options); });
  return new Hierarchy(std::move(bvh));
}

nb::tuple refit(Hierarchy& hierarchy, const std::vector<Rows>& vertices, const std::vector<Rows>& faces,
                const std::string& builder, const std::string& quality, double max_refinement_seconds,
                float alpha, float max_reference_ratio, unsigned max_leaf_size, unsigned threads,
                bool skip_non_finite, std::size_t presplit_references, const RayRows& sample_rays,
                const nb::object& progress) {
  const Meshes meshes(vertices, faces, std::vector<std::uint32_t>(vertices.size(), Mask{}.bits));
  RefitReport report;
  run(meshes,
      options_of(builder, quality, max_refinement_seconds, alpha, max_reference_ratio, max_leaf_size, threads,
                 skip_non_finite, presplit_references, rays_of(sample_rays)),
      progress, [&](const BuildOptions& options) { report = hierarchy.refit(meshes.floats, options); });
  return nb::make_tuple(report.cost_ratio, report.rebuilt);
}

nb::tuple measure(const std::vector<Rows>& vertices, const std::vector<Rows>& faces,
                  const std::string& builder, const std::string& quality, float alpha,
                  float max_reference_ratio, unsigned max_leaf_size, unsigned threads) {
  const Meshes meshes(vertices, faces, std::vector<std::uint32_t>(vertices.size(), Mask{}.bits));
  const BuildOptions options = options_of(builder, quality, std::numeric_limits<double>::infinity(), alpha,
                                          max_reference_ratio, max_leaf_size, threads, false, 0, {});
  struct Measures {
    TreeCounts counts;
    double sah, epo, lcv;
  };
  const Measures m = unlocked([&] {
    const Tree tree = build_tree(meshes.floats, options);
    return Measures{count_tree(tree), surface_area_cost(tree), end_point_overlap(tree),
                    leaf_count_variability(tree)};
  });
  return nb::make_tuple(m.sah, m.epo, m.lcv, m.counts.references, m.counts.nodes, m.counts.leaves,
                        m.counts.depth);
}

}  // namespace

void add_build(nb::module_& module) {
  module.def("build", &build, nb::arg("vertices").noconvert(), nb::arg("faces").noconvert(), nb::arg("masks"),
             nb::arg("builder"), nb::arg("quality"), nb::arg("max_refinement_seconds"), nb::arg("alpha"),
             nb::arg("max_reference_ratio"), nb::arg("max_leaf_size"), nb::arg("threads"),
             nb::arg("skip_non_finite"), nb::arg("presplit_references"), nb::arg("sample_rays"),
             nb::arg("progress").none());
  module.def("refit", &refit, nb::arg("bvh"), nb::arg("vertices").noconvert(), nb::arg("faces").noconvert(),
             nb::arg("builder"), nb::arg("quality"), nb::arg("max_refinement_seconds"), nb::arg("alpha"),
             nb::arg("max_reference_ratio"), nb::arg("max_leaf_size"), nb::arg("threads"),
             nb::arg("skip_non_finite"), nb::arg("presplit_references"), nb::arg("sample_rays"),
             nb::arg("progress").none());
  module.def("measure", &measure);
  module.def(
      "build_memory_bound", [](std::size_t triangles, const std::string& builder, float max_reference_ratio) {
        return build_memory_bound(
            triangles, {.builder = builder_named(builder), .max_reference_ratio = max_reference_ratio});
      });
}

}  // namespace kerf::python
