// Scenes of instances, and what is asked of them.
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <unordered_map>
#include <vector>

#include <kerf/scene.hpp>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "rays.hpp"

namespace kerf::python {
namespace {

/// Instance i is `objects[which[i]]`, a hierarchy or a scene, under twelve numbers of `transforms`.
Scene* build_scene(const nb::list& objects, const Answers<const std::uint32_t>& which,
                   const Answers<const double>& transforms, const Answers<const std::uint32_t>& masks,
                   const Answers<const std::uint32_t>& numbers, unsigned threads) {
  std::vector<Instance> kinds(nb::len(objects));
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    const nb::handle object = objects[i];
    if (nb::isinstance<Scene>(object)) {
      kinds[i].scene = nb::cast<const Scene&>(object);
    } else {
      kinds[i].object = nb::cast<const Hierarchy&>(object).now();
    }
  }
  return new Scene(unlocked([&] {
    std::vector<Instance> instances(which.size());
    for (std::size_t i = 0; i < instances.size(); ++i) {
      instances[i] = kinds[which.data()[i]];
      std::memcpy(instances[i].transform.rows, transforms.data() + 12 * i,
                  sizeof(instances[i].transform.rows));
      instances[i].mask = {masks.data()[i]};
      instances[i].number = numbers.data()[i];
    }
    return kerf::build(std::span<const Instance>(instances), {.threads = threads});
  }));
}

/// What stands in a scene, each kind once, with a number by which it is known in other scenes; then, for each
/// instance, which of them, and its own transform, mask and number.
nb::tuple parts(const Scene& scene) {
  nb::list kinds, identities;
  std::unordered_map<const void*, std::uint32_t> known;
  std::vector<std::uint32_t> which, masks, numbers;
  std::vector<double> transforms;
  for (const Instance& instance : scene.instances()) {
    const bool is_object = instance.scene.instances().empty();
    const void* const identity = is_object ? instance.object.identity() : instance.scene.identity();
    const auto [kind, is_new] = known.try_emplace(identity, static_cast<std::uint32_t>(known.size()));
    if (is_new) {
      if (is_object) {
        kinds.append(nb::cast(new Hierarchy(instance.object), nb::rv_policy::take_ownership));
      } else {
        kinds.append(nb::cast(new Scene(instance.scene), nb::rv_policy::take_ownership));
      }
      identities.append(reinterpret_cast<std::uintptr_t>(identity));
    }
    which.push_back(kind->second);
    masks.push_back(instance.mask.bits);
    numbers.push_back(instance.number);
    for (const auto& row : instance.transform.rows)
      transforms.insert(transforms.end(), std::begin(row), std::end(row));
  }
  return nb::make_tuple(kinds, identities, to_bytes(std::move(which)), to_bytes(std::move(transforms)),
                        to_bytes(std::move(masks)), to_bytes(std::move(numbers)));
}

using Limits = std::optional<Numbers<float>>;

using Flags = std::optional<Answers<const std::uint8_t>>;
using Places = std::optional<Answers<const std::int64_t>>;

/// What counts. Of instances a byte for each; of triangles a byte for each of the objects that say so, mesh
/// after mesh.
struct Accepted {
  const Flags& instances;
  const Places&
      starts;  ///< for each instance, where those of its object begin in `firsts`; below 0: all count
  const Places& firsts;  ///< where each mesh begins in `triangles`
  const Flags& triangles;

  bool are_all() const { return !instances && !starts; }

  bool operator()(std::size_t, const SceneHit& hit) const {
    if (instances && instances->data()[hit.instance] == 0) return false;
    if (!starts) return true;
    const std::int64_t start = starts->data()[hit.instance];
    return start < 0 || triangles->data()[firsts->data()[start + hit.mesh] + hit.primitive] != 0;
  }
};

void intersect(const Scene& scene, const Triples& origins, const Triples& directions, const Limits& t_min,
               const Limits& t_max, const std::optional<Numbers<std::uint32_t>>& mask, const Flags& instances,
               const Places& starts, const Places& firsts, const Flags& triangles, const Bytes& answers,
               unsigned threads) {
  const Rays rays(origins, directions, t_min, t_max, mask);
  const Accepted accepted{instances, starts, firsts, triangles};
  in_slices(rays.view.count, [&](std::size_t first, std::size_t count) {
    const std::span<SceneHit> hits = records<SceneHit>(answers).subspan(first, count);
    if (accepted.are_all()) {
      scene.intersect(rays.slice(first, count), hits, {.threads = threads});
    } else {
      scene.intersect(rays.slice(first, count), hits, accepted, {.threads = threads});
    }
  });
}

void occluded(const Scene& scene, const Triples& origins, const Triples& directions, const Limits& t_min,
              const Limits& t_max, const std::optional<Numbers<std::uint32_t>>& mask, const Flags& instances,
              const Places& starts, const Places& firsts, const Flags& triangles, const Bytes& answers,
              unsigned threads) {
  const Rays rays(origins, directions, t_min, t_max, mask);
  const Accepted accepted{instances, starts, firsts, triangles};
  in_slices(rays.view.count, [&](std::size_t first, std::size_t count) {
    const FlagView flags(answers.data() + first, count);
    if (accepted.are_all()) {
      scene.occluded(rays.slice(first, count), flags, {.threads = threads});
    } else {
      scene.occluded(rays.slice(first, count), flags, accepted, {.threads = threads});
    }
  });
}

void count_hits(const Scene& scene, const Triples& origins, const Triples& directions, const Limits& t_min,
                const Limits& t_max, const Answers<std::uint32_t>& counts, unsigned threads) {
  const Rays rays(origins, directions, t_min, t_max, {});
  in_slices(rays.view.count, [&](std::size_t first, std::size_t count) {
    scene.count_hits(rays.slice(first, count), {counts.data() + first, count}, {.threads = threads});
  });
}

nb::tuple all_hits(const Scene& scene, const Triples& origins, const Triples& directions, const Limits& t_min,
                   const Limits& t_max, unsigned threads) {
  const Rays rays(origins, directions, t_min, t_max, {});
  return to_tuple(list_in_slices<SceneHit>(rays.view.count, [&](std::size_t first, std::size_t count) {
    return scene.all_hits(rays.slice(first, count), {.threads = threads});
  }));
}

void geometry(const Scene& scene, const Triples& origins, const Triples& directions, const Bytes& hits,
              const Answers<float>& corners, const Answers<float>& normals, const Bytes& front) {
  const Rays rays(origins, directions, {}, {}, {});
  in_slices(rays.view.count, [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const SceneHit& hit = records<SceneHit>(hits)[i];
      if (!hit) continue;
      const HitGeometry geometry = scene.geometry(rays[i], hit);
      std::memcpy(corners.data() + 9 * i, &geometry.triangle, sizeof(geometry.triangle));
      std::memcpy(normals.data() + 3 * i, &geometry.normal, sizeof(geometry.normal));
      front.data()[i] = geometry.front ? 1 : 0;
    }
  });
}

/// Writes the corners of the triangles that are in leaves.
void triangles(const Scene& scene, const Bytes& ids, const Answers<float>& corners) {
  const std::span<ScenePrimitiveId> span = records<ScenePrimitiveId>(ids);
  in_slices(span.size(), [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const auto triangle = scene.triangle(span[i]);
      if (triangle) std::memcpy(corners.data() + 9 * i, &*triangle, sizeof(*triangle));
    }
  });
}

void side(const Scene& scene, const Triples& points, const Bytes& sides, unsigned threads) {
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    scene.side(points_of(points, first, count), records<Side>(sides).subspan(first, count),
               {.threads = threads});
  });
}

void contains(const Scene& scene, const Triples& points, const Bytes& inside, unsigned threads) {
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    scene.contains(points_of(points, first, count), FlagView(inside.data() + first, count),
                   {.threads = threads});
  });
}

void signed_distance(const Scene& scene, const Triples& points, const Answers<float>& distances,
                     unsigned threads) {
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    scene.signed_distance(points_of(points, first, count), {distances.data() + first, count},
                          {.threads = threads});
  });
}

void closest_point(const Scene& scene, const Triples& points, const Bytes& closest, float max_distance,
                   unsigned threads) {
  in_slices(points.shape(0), [&](std::size_t first, std::size_t count) {
    scene.closest_point(points_of(points, first, count), records<ScenePoint>(closest).subspan(first, count),
                        max_distance, {.threads = threads});
  });
}

nb::tuple nearest(const Scene& scene, const Triples& points, std::size_t count, float max_distance,
                  unsigned threads) {
  return to_tuple(list_in_slices<ScenePoint>(points.shape(0), [&](std::size_t first, std::size_t some) {
    return scene.nearest(points_of(points, first, some), count, max_distance, {.threads = threads});
  }));
}

nb::tuple within(const Scene& scene, const Triples& points, float radius, unsigned threads) {
  return to_tuple(list_in_slices<ScenePoint>(points.shape(0), [&](std::size_t first, std::size_t count) {
    return scene.within(points_of(points, first, count), radius, {.threads = threads});
  }));
}

nb::tuple triangles_in(const Scene& scene, const Numbers<float>& boxes, unsigned threads) {
  const std::span<const Box3f> span(reinterpret_cast<const Box3f*>(boxes.data()), boxes.size() / 6);
  return to_tuple(list_in_slices<ScenePrimitiveId>(span.size(), [&](std::size_t first, std::size_t count) {
    return scene.triangles_in(span.subspan(first, count), {.threads = threads});
  }));
}

Transform transform_of(const std::array<double, 12>& numbers) {
  Transform transform;
  std::memcpy(transform.rows, numbers.data(), sizeof(transform.rows));
  return transform;
}

nb::ndarray<nb::numpy, std::uint8_t, nb::ndim<1>> touching_pairs(const Scene& scene, const Scene& other,
                                                                 const std::array<double, 12>& transform,
                                                                 unsigned threads) {
  return to_bytes(
      unlocked([&] { return scene.touching_pairs(other, transform_of(transform), {.threads = threads}); }));
}

nb::ndarray<nb::numpy, std::uint8_t, nb::ndim<1>> own_touching_pairs(const Scene& scene, unsigned threads) {
  return to_bytes(unlocked([&] { return scene.touching_pairs({.threads = threads}); }));
}

bool touches(const Scene& scene, const Scene& other, const std::array<double, 12>& transform) {
  return unlocked([&] { return scene.touches(other, transform_of(transform)); });
}

nb::tuple bounds(const Scene& scene) {
  const Box3f box = scene.bounds();
  return nb::make_tuple(nb::make_tuple(box.lower.x, box.lower.y, box.lower.z),
                        nb::make_tuple(box.upper.x, box.upper.y, box.upper.z));
}

}  // namespace

void add_scene(nb::module_& module) {
  nb::class_<Scene>(module, "Scene")
      .def("instance_count", &Scene::instance_count)
      .def("path", [](const Scene& scene,
                      std::uint32_t instance) { return nb::tuple(nb::cast(scene.path(instance))); })
      .def("bounds", &bounds)
      .def("bytes", &Scene::bytes)
      .def("parts", &parts)
      .def("save", [](const Scene& scene, const std::filesystem::path& path) {
        return unlocked([&] { return scene.save(path); });
      });
  module.def("build_scene", &build_scene);
  module.def("load_scene", [](const std::filesystem::path& path) {
    return new Scene(unlocked([&] { return Scene::load(path); }));
  });
  module.def("map_scene", [](const std::filesystem::path& path) {
    return new Scene(unlocked([&] { return Scene::map(path); }));
  });
  module.def("scene_intersect", &intersect);
  module.def("scene_occluded", &occluded);
  module.def("scene_count_hits", &count_hits);
  module.def("scene_all_hits", &all_hits);
  module.def("scene_geometry", &geometry);
  module.def("scene_triangles", &triangles);
  module.def("scene_side", &side);
  module.def("scene_contains", &contains);
  module.def("scene_signed_distance", &signed_distance);
  module.def("scene_closest_point", &closest_point);
  module.def("scene_nearest", &nearest);
  module.def("scene_within", &within);
  module.def("scene_triangles_in", &triangles_in);
  module.def("scene_touching_pairs", &touching_pairs);
  module.def("scene_own_touching_pairs", &own_touching_pairs);
  module.def("scene_touches", &touches);
}

}  // namespace kerf::python
