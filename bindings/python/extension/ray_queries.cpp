// Questions of rays.
#include <cstring>
#include <vector>

#include "arrays.hpp"
#include "rays.hpp"

namespace kerf::python {
namespace {

/// Which triangles count: a byte for each, mesh after mesh, and where each mesh begins.
struct Accepted {
  const std::uint8_t* flags;
  const std::int64_t* first_of_mesh;

  bool operator()(std::size_t, const Hit& hit) const {
    return flags[first_of_mesh[hit.mesh] + hit.primitive] != 0;
  }
};

using Flags = std::optional<Numbers<std::uint8_t>>;
using Offsets = std::optional<Numbers<std::int64_t>>;

void intersect(const Hierarchy& hierarchy, const Triples& origins, const Triples& directions,
               const std::optional<Numbers<float>>& t_min, const std::optional<Numbers<float>>& t_max,
               const std::optional<Numbers<std::uint32_t>>& mask, const Flags& accepted,
               const Offsets& offsets, Answers<float> t, Answers<float> u, Answers<float> v,
               Answers<std::uint32_t> primitive, Answers<std::uint32_t> mesh, unsigned threads) {
  const Bvh bvh = hierarchy.now();
  const Rays rays(origins, directions, t_min, t_max, mask);
  in_slices(rays.view.count, [&](std::size_t first, std::size_t count) {
    HitView hits;
    hits.count = count;
    hits.t.data = t.data() + first;
    hits.u.data = u.data() + first;
    hits.v.data = v.data() + first;
    hits.primitive.data = primitive.data() + first;
    hits.mesh.data = mesh.data() + first;
    if (accepted) {
      bvh.intersect(rays.slice(first, count), hits, Accepted{accepted->data(), offsets->data()},
                    {.threads = threads});
    } else {
      bvh.intersect(rays.slice(first, count), hits, {.threads = threads});
    }
  });
}

void occluded(const Hierarchy& hierarchy, const Triples& origins, const Triples& directions,
              const std::optional<Numbers<float>>& t_min, const std::optional<Numbers<float>>& t_max,
              const std::optional<Numbers<std::uint32_t>>& mask, const Flags& accepted,
              const Offsets& offsets, Bytes answers, unsigned threads) {
  const Bvh bvh = hierarchy.now();
  const Rays rays(origins, directions, t_min, t_max, mask);
  in_slices(rays.view.count, [&](std::size_t first, std::size_t count) {
    const FlagView flags(answers.data() + first, count);
    if (accepted) {
      bvh.occluded(rays.slice(first, count), flags, Accepted{accepted->data(), offsets->data()},
                   {.threads = threads});
    } else {
      bvh.occluded(rays.slice(first, count), flags, {.threads = threads});
    }
  });
}

void count_hits(const Hierarchy& hierarchy, const Triples& origins, const Triples& directions,
                const std::optional<Numbers<float>>& t_min, const std::optional<Numbers<float>>& t_max,
                Answers<std::uint32_t> counts, unsigned threads) {
  const Bvh bvh = hierarchy.now();
  const Rays rays(origins, directions, t_min, t_max, {});
  in_slices(rays.view.count, [&](std::size_t first, std::size_t count) {
    bvh.count_hits(rays.slice(first, count), {counts.data() + first, count}, {.threads = threads});
  });
}

nb::tuple all_hits(const Hierarchy& hierarchy, const Triples& origins, const Triples& directions,
                   const std::optional<Numbers<float>>& t_min, const std::optional<Numbers<float>>& t_max,
                   unsigned threads) {
  const Bvh bvh = hierarchy.now();
  const Rays rays(origins, directions, t_min, t_max, {});
  return to_tuple(list_in_slices<Hit>(rays.view.count, [&](std::size_t first, std::size_t count) {
    return bvh.all_hits(rays.slice(first, count), {.threads = threads});
  }));
}

void geometry(const Hierarchy& hierarchy, const Triples& origins, const Triples& directions, Numbers<float> t,
              Numbers<float> u, Numbers<float> v, Numbers<std::uint32_t> primitive,
              Numbers<std::uint32_t> mesh, Answers<float> corners, Answers<float> normals, Bytes front) {
  const Bvh bvh = hierarchy.now();
  const Rays rays(origins, directions, {}, {}, {});
  const auto at = [](const auto& numbers, std::size_t i) {
    return numbers.data()[static_cast<std::int64_t>(i) * numbers.stride(0)];
  };
  in_slices(rays.view.count, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const Hit hit{
          .t = at(t, i), .u = at(u, i), .v = at(v, i), .primitive = at(primitive, i), .mesh = at(mesh, i)};
      if (!hit) continue;
      const HitGeometry geometry = bvh.geometry(rays[i], hit);
      std::memcpy(corners.data() + 9 * i, &geometry.triangle, sizeof(geometry.triangle));
      std::memcpy(normals.data() + 3 * i, &geometry.normal, sizeof(geometry.normal));
      front.data()[i] = geometry.front ? 1 : 0;
    }
  });
}

}  // namespace

void add_ray_queries(nb::module_& module) {
  module.def("intersect", &intersect);
  module.def("occluded", &occluded);
  module.def("count_hits", &count_hits);
  module.def("all_hits", &all_hits);
  module.def("geometry", &geometry);
}

}  // namespace kerf::python
