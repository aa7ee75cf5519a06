#include "workbench/formats/faces.hpp"

#include <utility>

#include "workbench/formats/triangulate.hpp"

namespace workbench {

std::vector<Faces::Triangle> Faces::take_triangles(std::span<const kerf::Vec3f> vertices,
                                                   std::size_t& crossing) {
  Faces faces = std::exchange(*this, {});
  crossing = 0;
  if (faces.polygons_.empty()) return std::move(faces.triangles_);
  std::vector<Triangle> all;
  reserve_large(all, faces.triangles_.size() + faces.corners_.size() - 2 * faces.polygons_.size());
  Triangulator triangulator;
  std::size_t done = 0;  // of the triangles
  const auto copy_until = [&](std::size_t end) {
    all.insert(all.end(), faces.triangles_.begin() + static_cast<std::ptrdiff_t>(done),
               faces.triangles_.begin() + static_cast<std::ptrdiff_t>(end));
    done = end;
  };
  for (const Polygon& polygon : faces.polygons_) {
    copy_until(polygon.triangles_before);
    triangulator.append(vertices, std::span(faces.corners_).subspan(polygon.first_corner, polygon.corners),
                        all);
  }
  copy_until(faces.triangles_.size());
  crossing = triangulator.crossing();
  return all;
}

}  // namespace workbench
