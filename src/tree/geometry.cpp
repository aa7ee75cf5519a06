#include "tree/geometry.hpp"

#include <algorithm>

#include <kerf/error.hpp>

namespace kerf {

Geometry::Geometry(std::span<const TriangleMesh> meshes) : meshes_(meshes) {
  first_.reserve(meshes.size() + 1);
  std::size_t count = 0;
  first_.push_back(0);
  for (const TriangleMesh& mesh : meshes) {
    count += mesh.triangles.size();
    if (count >= (std::size_t{1} << 31)) {
      throw Error(Error::too_large,
                  "the meshes have 2^31 triangles or more, which is more than kerf can number");
    }
    first_.push_back(static_cast<std::uint32_t>(count));
  }
}

std::uint32_t Geometry::mesh_of(std::uint32_t id) const {
  return static_cast<std::uint32_t>(std::upper_bound(first_.begin(), first_.end(), id) - first_.begin() - 1);
}

}  // namespace kerf
