// The extension module `kerf_bvh._kerf`: kerf's calls over arrays that kerf_bvh/_arrays.py has prepared.
#include <filesystem>

#include <nanobind/stl/filesystem.h>

#include "arrays.hpp"

namespace kerf::python {
namespace {

PyObject* type_of(Error::Code code, PyObject* cancelled) {
  switch (code) {
    case Error::out_of_memory:
      return PyExc_MemoryError;
    case Error::io:
      return PyExc_OSError;
    case Error::cancelled:
      return cancelled;
    default:
      return PyExc_ValueError;
  }
}

nb::tuple statistics(const Hierarchy& hierarchy) {
  const Bvh bvh = hierarchy.now();
  const BvhStatistics& s = bvh.statistics();
  return nb::make_tuple(s.triangles, s.degenerate_triangles, s.non_finite_triangles, s.degenerate_by_rounding,
                        s.references, s.nodes, s.bytes, s.build_peak_bytes, s.build_seconds);
}

nb::tuple coordinates(const Vec3f& v) {
  return nb::make_tuple(v.x, v.y, v.z);
}

nb::tuple bounds(const Hierarchy& hierarchy) {
  const Box3f box = hierarchy.now().bounds();
  return nb::make_tuple(coordinates(box.lower), coordinates(box.upper));
}

nb::tuple origin(const Hierarchy& hierarchy) {
  const Vec3d o = hierarchy.now().origin();
  return nb::make_tuple(o.x, o.y, o.z);
}

nb::list mesh_statistics(const Hierarchy& hierarchy) {
  const Bvh bvh = hierarchy.now();
  nb::list list;
  for (const MeshStatistics& s : unlocked([&] { return bvh.mesh_statistics(); })) {
    list.append(nb::make_tuple(s.triangles, s.left_out, s.references, coordinates(s.bounds.lower),
                               coordinates(s.bounds.upper)));
  }
  return list;
}

}  // namespace
}  // namespace kerf::python

NB_MODULE(_kerf, module) {
  using namespace kerf;
  using namespace kerf::python;
  module.doc() = "kerf's calls over prepared arrays; kerf_bvh is the interface";

  static PyObject* cancelled = PyErr_NewExceptionWithDoc(
      "kerf_bvh.Cancelled", "A build was stopped by its progress callback, which returned False.", nullptr,
      nullptr);
  module.attr("Cancelled") = nb::handle(cancelled);
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const Error& error) {
      PyErr_SetString(type_of(error.code(), cancelled), error.what());
    }
  });

  nb::class_<Hierarchy>(module, "Bvh")
      .def(nb::init<>())
      .def("origin", &origin)
      .def("bounds", &bounds)
      .def("statistics", &statistics)
      .def("mesh_statistics", &mesh_statistics)
      .def("save", [](const Hierarchy& hierarchy, const std::filesystem::path& path) {
        const Bvh bvh = hierarchy.now();
        return unlocked([&] { return bvh.save(path); });
      });
  module.def("load", [](const std::filesystem::path& path) {
    return new Hierarchy(unlocked([&] { return Bvh::load(path); }));
  });
  module.def("map", [](const std::filesystem::path& path) {
    return new Hierarchy(unlocked([&] { return Bvh::map(path); }));
  });

  add_build(module);
  add_ray_queries(module);
  add_point_queries(module);
  add_shape_queries(module);
  add_scene(module);
#ifdef KERF_PYTHON_CUDA
  add_cuda(module);
#endif
}
