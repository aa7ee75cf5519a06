#include <algorithm>

#include <kerf/bvh.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "queries/batches.hpp"
#include "queries/triangle_box.hpp"
#include "queries/visit_box.hpp"

namespace kerf {
namespace {

void append_triangles_in(const Structure& structure, const Box3f& box, std::vector<PrimitiveId>& places) {
  // Exact arithmetic needs finite corners.
  const Box3f finite = intersect(box, structure.wide.bounds);
  if (finite.empty()) return;
  std::vector<std::uint32_t> ids;
  visit_box(structure, finite, [&](std::uint32_t id, const Triangle& triangle) {
    if (overlaps(triangle, finite)) ids.push_back(id);
    return true;
  });
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  for (const std::uint32_t id : ids) places.push_back(locate(structure, id));
}

}  // namespace

std::vector<PrimitiveId> Bvh::triangles_in(const Box3f& box) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    std::vector<PrimitiveId> places;
    append_triangles_in(*structure_, box, places);
    return places;
  });
}

Lists<PrimitiveId> Bvh::triangles_in(std::span<const Box3f> boxes, const BatchOptions& options) const {
  return list_in_batches<PrimitiveId>(boxes.size(), points_per_batch, options,
                                      [&](std::size_t i, std::vector<PrimitiveId>& places) {
                                        append_triangles_in(*structure_, boxes[i], places);
                                      });
}

}  // namespace kerf
