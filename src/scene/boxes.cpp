// The triangles of a scene that have a point in a box.
#include <algorithm>
#include <tuple>
#include <vector>

#include <kerf/scene.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "math/box3f.hpp"
#include "queries/batches.hpp"
#include "queries/triangle_box.hpp"
#include "queries/visit_box.hpp"
#include "scene/chain.hpp"
#include "scene/objects_in.hpp"
#include "scene/places.hpp"

namespace kerf {
namespace {

void append_triangles_in(const SceneStructure& scene, const Box3f& box,
                         std::vector<ScenePrimitiveId>& found) {
  // Exact arithmetic needs finite corners.
  const Box3f finite = intersect(box, scene.top.bounds);
  if (finite.empty()) return;
  const auto before = static_cast<std::ptrdiff_t>(found.size());
  std::vector<std::uint32_t> ids;
  visit_objects_in(
      scene, finite, 0, nullptr,
      [&](const Structure& object, std::uint32_t number, const Chain& chain, const Box3f& local) {
        ids.clear();
        visit_box(object, local, [&](std::uint32_t id, const Triangle& triangle) {
          if (overlaps(chain(triangle), finite)) ids.push_back(id);
          return true;
        });
        std::sort(ids.begin(), ids.end());
        ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
        for (const std::uint32_t id : ids) {
          const PrimitiveId place = locate(object, id);
          found.push_back({place.primitive, place.mesh, number});
        }
      });
  std::sort(found.begin() + before, found.end(), [](const ScenePrimitiveId& a, const ScenePrimitiveId& b) {
    return std::tie(a.instance, a.mesh, a.primitive) < std::tie(b.instance, b.mesh, b.primitive);
  });
}

}  // namespace

std::vector<ScenePrimitiveId> Scene::triangles_in(const Box3f& box) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    std::vector<ScenePrimitiveId> found;
    append_triangles_in(*structure_, box, found);
    return found;
  });
}

Lists<ScenePrimitiveId> Scene::triangles_in(std::span<const Box3f> boxes, const BatchOptions& options) const {
  return list_in_batches<ScenePrimitiveId>(boxes.size(), points_per_batch, options,
                                           [&](std::size_t i, std::vector<ScenePrimitiveId>& found) {
                                             append_triangles_in(*structure_, boxes[i], found);
                                           });
}

}  // namespace kerf
