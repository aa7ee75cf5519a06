// Hierarchies in the memory of a GPU: `kerf_bvh.cuda`.
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <kerf/cuda/bvh.hpp>
#include <kerf/cuda/gather.hpp>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "cuda_arrays.hpp"

namespace kerf::python {
namespace {

/// A hierarchy and the device that it is on.
struct DeviceHierarchy {
  cuda::Bvh bvh;
  int device = 0;
};

/// What Python holds of memory.
struct SharedMemory {
  std::shared_ptr<DeviceMemory> memory;
};

Stream stream_of(std::uintptr_t number) {
  return reinterpret_cast<Stream>(number);
}

cuda::BuildOptions options_of(float max_reference_ratio, std::uint32_t max_leaf_size, std::uint32_t radius) {
  const cuda::BuildOptions options{
      .max_reference_ratio = max_reference_ratio, .max_leaf_size = max_leaf_size, .radius = radius};
  try {
    cuda::build_bytes(0, options);  // which refuses what is out of range, and asks no device
  } catch (const cuda::Error& error) {
    const std::string_view before = "CUDA: while building: ", text = error.what();
    throw nb::value_error(error.what() + (text.substr(0, before.size()) == before ? before.size() : 0));
  }
  return options;
}

/// Meshes whose vertices and triangles lie on a device.
class DeviceMeshes {
 public:
  DeviceMeshes(const nb::list& vertices, const nb::list& faces, const std::vector<std::string>& names,
               std::optional<int> device, Stream stream)
      : device_(device) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      taken_.emplace_back(vertices[i], names[i] + "vertices", stream);
      if (!device_) device_ = taken_.back().device();
      TriangleMesh mesh;
      mesh.vertices = taken_.back().vertices(*device_);
      taken_.emplace_back(faces[i], names[i] + "faces", stream);
      mesh.triangles = taken_.back().triangles(*device_);
      meshes_.push_back(mesh);
    }
  }

  std::span<const TriangleMesh> meshes() const { return meshes_; }
  int device() const { return device_.value_or(0); }

 private:
  std::optional<int> device_;
  std::vector<TakenArray> taken_;
  std::vector<TriangleMesh> meshes_;
};

/// Rays as rows, as they are given or gathered from a tuple of origins, directions, t_min and t_max. Of
/// these, tuples of three floats and single floats stand for all rays.
class TakenRays {
 public:
  TakenRays(nb::handle given, std::optional<int> device, Stream stream) : stream_(stream), device_(device) {
    if (!nb::isinstance<nb::tuple>(given)) {
      taken_.emplace_back(given, "rays", stream);
      if (!device_) device_ = taken_.back().device();
      rows_ = taken_.back().elements<const Ray>(*device_);
      return;
    }
    taken_.reserve(4);
    const auto parts = nb::borrow<nb::tuple>(given);
    triples(parts[0], "origins", columns_.origin, otherwise_.origin);
    triples(parts[1], "directions", columns_.direction, otherwise_.direction);
    numbers(parts[2], "t_min", columns_.t_min, otherwise_.t_min);
    numbers(parts[3], "t_max", columns_.t_max, otherwise_.t_max);
    if (taken_.empty())
      throw nb::value_error("origins and directions: neither of them is an array of a device");
    is_gathered_ = true;
  }

  std::size_t count() const { return is_gathered_ ? columns_.count : rows_.size(); }
  int device() const { return device_.value_or(0); }

  /// Writes the rows.
  void gather(Ray* rows) const { cuda::gather_rays(columns_, otherwise_, rows, stream_); }

  /// The rows where they lie, or in memory that is given back behind what is on the stream by then.
  const Ray* rows() {
    if (!is_gathered_) return rows_.data();
    scratch_ = ScratchMemory(columns_.count * sizeof(Ray), stream_);
    gather(static_cast<Ray*>(scratch_.data()));
    return static_cast<const Ray*>(scratch_.data());
  }

 private:
  const TakenArray& take(nb::handle part, const char* name) {
    taken_.emplace_back(part, name, stream_);
    if (!device_) device_ = taken_.back().device();
    return taken_.back();
  }
  void set_count(const TakenArray& array, std::size_t count) {
    if (taken_.size() > 1 && count != columns_.count)
      array.fail("there are " + std::to_string(count) + " of them for " + std::to_string(columns_.count) +
                 " rays");
    columns_.count = count;
  }
  void triples(nb::handle part, const char* name, Column<const float>* columns, Vec3f& otherwise) {
    if (nb::isinstance<nb::tuple>(part)) {
      for (int axis = 0; axis < 3; ++axis) otherwise[axis] = nb::cast<float>(part[axis]);
      return;
    }
    const TakenArray& array = take(part, name);
    const TripleView<float> view = array.vertices(*device_);
    set_count(array, view.size());
    for (int axis = 0; axis < 3; ++axis)
      columns[axis] = {reinterpret_cast<const float*>(view.data()) + axis,
                       static_cast<std::ptrdiff_t>(view.stride())};
  }
  void numbers(nb::handle part, const char* name, Column<const float>& column, float& otherwise) {
    if (nb::isinstance<nb::float_>(part)) {
      otherwise = nb::cast<float>(part);
      return;
    }
    const TakenArray& array = take(part, name);
    const std::span<const float> view = array.elements<const float>(*device_);
    set_count(array, view.size());
    column.data = view.data();
  }

  Stream stream_;
  std::optional<int> device_;
  std::vector<TakenArray> taken_;
  std::span<const Ray> rows_;
  bool is_gathered_ = false;
  RayView columns_;
  Ray otherwise_;
  ScratchMemory scratch_;
};

/// Where answers go: an array of the caller's, or memory that is made.
template <class T>
class Answered {
 public:
  Answered(nb::handle out, std::size_t count, int device, Stream stream) : stream_(stream), count_(count) {
    if (out.is_none()) {
      memory_ = std::make_shared<DeviceMemory>(device, count * sizeof(T));
      data_ = reinterpret_cast<T*>(memory_->data());
      return;
    }
    taken_.emplace(out, "out", stream);
    const std::span<T> view = taken_->template elements<T>(device);
    if (view.size() != count)
      taken_->fail("it has " + std::to_string(view.size()) + " rows, not " + std::to_string(count));
    data_ = view.data();
  }

  T* data() const { return data_; }

  /// None for an array of the caller's; else the memory, which those who read it wait for, and how many
  /// answers are there.
  nb::object finish() const {
    if (!memory_) return nb::none();
    memory_->mark_written(stream_);
    return nb::make_tuple(SharedMemory{memory_}, count_);
  }

 private:
  Stream stream_;
  std::size_t count_;
  std::optional<TakenArray> taken_;
  std::shared_ptr<DeviceMemory> memory_;
  T* data_ = nullptr;
};

// `call(rows, answers, count)` for rays; without Python's lock.
template <class T, class Call>
nb::object ask_rays(const DeviceHierarchy& hierarchy, nb::handle rays, nb::handle out, Stream stream,
                    const Call& call) {
  const OnDevice on(hierarchy.device);
  TakenRays taken(rays, hierarchy.device, stream);
  const Answered<T> answers(out, taken.count(), hierarchy.device, stream);
  unlocked([&] { call(taken.rows(), answers.data(), taken.count()); });
  return answers.finish();
}

// The same for points.
template <class T, class Call>
nb::object ask_points(const DeviceHierarchy& hierarchy, nb::handle points, nb::handle out, Stream stream,
                      const Call& call) {
  const OnDevice on(hierarchy.device);
  const TakenArray taken(points, "points", stream);
  const std::span<const Vec3f> view = taken.elements<const Vec3f>(hierarchy.device);
  const Answered<T> answers(out, view.size(), hierarchy.device, stream);
  unlocked([&] { call(view.data(), answers.data(), view.size()); });
  return answers.finish();
}

DeviceHierarchy* upload(const Hierarchy& hierarchy, std::optional<int> device) {
  const Bvh bvh = hierarchy.now();
  auto made = std::make_unique<DeviceHierarchy>();
  made->device = device.value_or(current_device());
  const OnDevice on(made->device);
  made->bvh = unlocked([&] { return cuda::Bvh(bvh); });
  return made.release();
}

DeviceHierarchy* build(const nb::list& vertices, const nb::list& faces, const std::vector<std::string>& names,
                       float max_reference_ratio, std::uint32_t max_leaf_size, std::uint32_t radius,
                       std::uintptr_t stream) {
  const cuda::BuildOptions options = options_of(max_reference_ratio, max_leaf_size, radius);
  const DeviceMeshes meshes(vertices, faces, names, {}, stream_of(stream));
  auto made = std::make_unique<DeviceHierarchy>();
  made->device = meshes.device();
  const OnDevice on(made->device);
  made->bvh = unlocked([&] { return cuda::Bvh::build(meshes.meshes(), options, stream_of(stream)); });
  return made.release();
}

void refit(DeviceHierarchy& hierarchy, const nb::list& vertices, const nb::list& faces,
           const std::vector<std::string>& names, std::uintptr_t stream) {
  const OnDevice on(hierarchy.device);
  const DeviceMeshes meshes(vertices, faces, names, hierarchy.device, stream_of(stream));
  unlocked([&] { hierarchy.bvh.refit(meshes.meshes(), stream_of(stream)); });
}

nb::object rays(nb::handle given, nb::handle out, std::optional<int> device, std::uintptr_t stream) {
  const TakenRays taken(given, device, stream_of(stream));
  const OnDevice on(taken.device());
  const Answered<Ray> answers(out, taken.count(), taken.device(), stream_of(stream));
  unlocked([&] { taken.gather(answers.data()); });
  return answers.finish();
}

nb::object intersect(const DeviceHierarchy& hierarchy, nb::handle rays, nb::handle out, std::uintptr_t s) {
  const Stream stream = stream_of(s);
  return ask_rays<Hit>(hierarchy, rays, out, stream, [&](const Ray* from, Hit* to, std::size_t count) {
    hierarchy.bvh.intersect(from, to, count, stream);
  });
}
nb::object occluded(const DeviceHierarchy& hierarchy, nb::handle rays, nb::handle out, std::uintptr_t s) {
  const Stream stream = stream_of(s);
  return ask_rays<std::uint8_t>(hierarchy, rays, out, stream,
                                [&](const Ray* from, std::uint8_t* to, std::size_t count) {
                                  hierarchy.bvh.occluded(from, to, count, stream);
                                });
}
nb::object count_hits(const DeviceHierarchy& hierarchy, nb::handle rays, nb::handle out, std::uintptr_t s) {
  const Stream stream = stream_of(s);
  return ask_rays<std::uint32_t>(hierarchy, rays, out, stream,
                                 [&](const Ray* from, std::uint32_t* to, std::size_t count) {
                                   hierarchy.bvh.count_hits(from, to, count, stream);
                                 });
}

void list_hits(const DeviceHierarchy& hierarchy, nb::handle rays, nb::handle offsets, nb::handle out,
               std::uintptr_t s) {
  const Stream stream = stream_of(s);
  const OnDevice on(hierarchy.device);
  TakenRays taken(rays, hierarchy.device, stream);
  const TakenArray firsts(offsets, "offsets", stream), hits(out, "out", stream);
  const auto first = firsts.elements<const std::uint64_t>(hierarchy.device);
  if (first.size() != taken.count() + 1)
    firsts.fail("there are " + std::to_string(first.size()) + " of them, not one more than the " +
                std::to_string(taken.count()) + " rays");
  const auto to = hits.elements<Hit>(hierarchy.device);
  unlocked([&] { hierarchy.bvh.list_hits(taken.rows(), first.data(), to.data(), taken.count(), stream); });
}

/// Offsets, hits, and how many of each there are.
nb::tuple all_hits(const DeviceHierarchy& hierarchy, nb::handle rays, std::uintptr_t s) {
  const Stream stream = stream_of(s);
  const OnDevice on(hierarchy.device);
  TakenRays taken(rays, hierarchy.device, stream);
  const std::size_t count = taken.count();
  std::shared_ptr<DeviceMemory> offsets, hits;
  std::uint64_t total = 0;
  unlocked([&] {
    const Ray* const rows = taken.rows();
    offsets = std::make_shared<DeviceMemory>(hierarchy.device, (count + 1) * sizeof(std::uint64_t));
    auto* const firsts = reinterpret_cast<std::uint64_t*>(offsets->data());
    const ScratchMemory scratch(count * sizeof(std::uint32_t), stream);
    auto* const counts = static_cast<std::uint32_t*>(scratch.data());
    hierarchy.bvh.count_hits(rows, counts, count, stream);
    cuda::sum_counts(counts, firsts, count, stream);
    check(cudaMemcpyAsync(&total, firsts + count, sizeof total, cudaMemcpyDeviceToHost, stream),
          "counting hits");
    check(cudaStreamSynchronize(stream), "counting hits");
    hits = std::make_shared<DeviceMemory>(hierarchy.device, total * sizeof(Hit));
    hierarchy.bvh.list_hits(rows, firsts, reinterpret_cast<Hit*>(hits->data()), count, stream);
    offsets->mark_written(stream);
    hits->mark_written(stream);
  });
  return nb::make_tuple(SharedMemory{offsets}, SharedMemory{hits}, count + 1, total);
}

nb::object contains(const DeviceHierarchy& hierarchy, nb::handle points, nb::handle out, std::uintptr_t s) {
  const Stream stream = stream_of(s);
  return ask_points<std::uint8_t>(hierarchy, points, out, stream,
                                  [&](const Vec3f* from, std::uint8_t* to, std::size_t count) {
                                    hierarchy.bvh.contains(from, to, count, stream);
                                  });
}
nb::object closest_point(const DeviceHierarchy& hierarchy, nb::handle points, float max_distance,
                         nb::handle out, std::uintptr_t s) {
  const Stream stream = stream_of(s);
  return ask_points<SurfacePoint>(hierarchy, points, out, stream,
                                  [&](const Vec3f* from, SurfacePoint* to, std::size_t count) {
                                    hierarchy.bvh.closest_point(from, to, count, max_distance, stream);
                                  });
}
nb::object signed_distance(const DeviceHierarchy& hierarchy, nb::handle points, nb::handle out,
                           std::uintptr_t s) {
  const Stream stream = stream_of(s);
  return ask_points<float>(hierarchy, points, out, stream,
                           [&](const Vec3f* from, float* to, std::size_t count) {
                             hierarchy.bvh.signed_distance(from, to, count, stream);
                           });
}

nb::tuple bounds(const DeviceHierarchy& hierarchy) {
  const OnDevice on(hierarchy.device);
  const Box3f box = unlocked([&] { return hierarchy.bvh.bounds(); });
  return nb::make_tuple(nb::make_tuple(box.lower.x, box.lower.y, box.lower.z),
                        nb::make_tuple(box.upper.x, box.upper.y, box.upper.z));
}

nb::tuple statistics(const DeviceHierarchy& hierarchy) {
  const cuda::BvhStatistics& s = hierarchy.bvh.statistics();
  return nb::make_tuple(s.triangles, s.degenerate_triangles, s.references, s.nodes, s.bytes, s.scratch_bytes,
                        s.cost);
}

SharedMemory allocate(std::size_t bytes, std::optional<int> device) {
  const int on = device.value_or(current_device());
  return {unlocked([&] { return std::make_shared<DeviceMemory>(on, bytes); })};
}

nb::capsule capsule(const SharedMemory& shared, std::size_t offset, const std::vector<std::int64_t>& shape,
                    const std::vector<std::int64_t>& strides, std::uint8_t code, std::uint8_t bits,
                    bool versioned) {
  if (shape.empty() || shape.size() > 2 || strides.size() != shape.size())
    throw nb::value_error("an array has one dimension or two");
  return to_capsule(shared.memory, offset, shape, strides, {code, bits, 1}, versioned);
}

/// Copies rows of `width` bytes, `pitch` bytes from one to the next, to the host.
void fetch(const SharedMemory& shared, std::size_t offset, std::size_t pitch, std::size_t width, Bytes to) {
  if (to.size() == 0) return;
  const DeviceMemory& memory = *shared.memory;
  const std::size_t rows = to.size() / width;
  if (pitch < width || offset > memory.bytes() || (rows - 1) * pitch + width > memory.bytes() - offset)
    throw nb::value_error("rows beyond the memory");
  const OnDevice on(memory.device());
  unlocked([&] {
    memory.wait();
    check(cudaMemcpy2D(to.data(), width, memory.data() + offset, pitch, width, rows, cudaMemcpyDeviceToHost),
          "copying from the device");
  });
}

}  // namespace

void add_cuda(nb::module_& module) {
  static PyObject* error = PyErr_NewExceptionWithDoc("kerf_bvh.cuda.Error",
                                                     "What CUDA or a build on the device says, in one line.",
                                                     PyExc_RuntimeError, nullptr);
  module.attr("CudaError") = nb::handle(error);
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const cuda::Error& what) {
      PyErr_SetString(error, what.what());
    }
  });

  nb::class_<SharedMemory>(module, "CudaMemory")
      .def_prop_ro(
          "address",
          [](const SharedMemory& shared) { return reinterpret_cast<std::uintptr_t>(shared.memory->data()); })
      .def_prop_ro("device", [](const SharedMemory& shared) { return shared.memory->device(); })
      .def("is_written", [](const SharedMemory& shared) { return shared.memory->is_written(); })
      .def("mark_written",
           [](const SharedMemory& shared, std::uintptr_t stream) {
             const OnDevice on(shared.memory->device());
             shared.memory->mark_written(stream_of(stream));
           })
      .def("make_wait", [](const SharedMemory& shared,
                           std::uintptr_t stream) { shared.memory->make_wait(stream_of(stream)); })
      .def("capsule", &capsule)
      .def("fetch", &fetch);
  nb::class_<DeviceHierarchy>(module, "CudaBvh")
      .def(nb::init<>())
      .def_prop_ro("device", [](const DeviceHierarchy& hierarchy) { return hierarchy.device; })
      .def("bounds", &bounds)
      .def("statistics", &statistics);
  module.def("cuda_allocate", &allocate, nb::arg("bytes"), nb::arg("device").none());
  module.def("cuda_upload", &upload, nb::arg("bvh"), nb::arg("device").none());
  module.def("cuda_build", &build);
  module.def("cuda_refit", &refit);
  module.def("cuda_rays", &rays, nb::arg("rays"), nb::arg("out").none(), nb::arg("device").none(),
             nb::arg("stream"));
  const auto with_out = [&](const char* name, auto call) {
    module.def(name, call, nb::arg("bvh"), nb::arg("rays").none(), nb::arg("out").none(), nb::arg("stream"));
  };
  with_out("cuda_intersect", &intersect);
  with_out("cuda_occluded", &occluded);
  with_out("cuda_count_hits", &count_hits);
  with_out("cuda_contains", &contains);
  with_out("cuda_signed_distance", &signed_distance);
  module.def("cuda_closest_point", &closest_point, nb::arg("bvh"), nb::arg("points").none(),
             nb::arg("max_distance"), nb::arg("out").none(), nb::arg("stream"));
  module.def("cuda_list_hits", &list_hits, nb::arg("bvh"), nb::arg("rays").none(), nb::arg("offsets").none(),
             nb::arg("out").none(), nb::arg("stream"));
  module.def("cuda_all_hits", &all_hits, nb::arg("bvh"), nb::arg("rays").none(), nb::arg("stream"));
  module.def("cuda_build_bytes", [](std::size_t triangles, float max_reference_ratio,
                                    std::uint32_t max_leaf_size, std::uint32_t radius) {
    return cuda::build_bytes(triangles, options_of(max_reference_ratio, max_leaf_size, radius));
  });
}

}  // namespace kerf::python
