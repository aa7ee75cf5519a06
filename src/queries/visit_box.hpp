// The triangles that may have a point in a box.
#pragma once

#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {

/// Calls `visit(id, triangle)` for each reference of a triangle whose bounds have a point in `box`, until
/// `visit` returns false. A triangle is visited once per reference.
template <class Visit>
void visit_box(const Structure& structure, const Box3f& box, Visit&& visit) {
  const WideBvh& bvh = structure.wide;
  if (bvh.empty()) return;
  auto visit_place = [&](ChildLink leaf, std::uint32_t place) {
    return visit(triangle_id(bvh, leaf, place), triangle_in(bvh, leaf, place));
  };
  using VisitPlace = decltype(visit_place);
  structure.kernels->visit_box(bvh, box, &visit_place,
                               [](void* visitor, ChildLink leaf, std::uint32_t place) {
                                 return (*static_cast<VisitPlace*>(visitor))(leaf, place);
                               });
}

}  // namespace kerf
