#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "queries/triangle_box.hpp"
#include "queries/visit_box.hpp"

namespace kerf {

std::vector<PrimitiveId> Bvh::triangles_in(const Box3f& box) const {
  const PlainFloatingPoint plain;
  // Exact arithmetic needs finite corners.
  const Box3f finite = kerf::intersect(box, structure_->wide.bounds);
  std::vector<PrimitiveId> places;
  if (finite.empty()) return places;
  report_out_of_memory([&] {
    std::vector<std::uint32_t> ids;
    visit_box(*structure_, finite, [&](std::uint32_t id, const Triangle& triangle) {
      if (overlaps(triangle, finite)) ids.push_back(id);
      return true;
    });
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    places.reserve(ids.size());
    for (const std::uint32_t id : ids) places.push_back(locate(*structure_, id));
  });
  return places;
}

}  // namespace kerf
