#include "tree/geometry.hpp"

#include "base/raise.hpp"

namespace kerf {

Geometry::Geometry(std::span<const TriangleMesh> meshes) : meshes_(meshes) {
  first_.reserve(meshes.size() + 1);
  std::size_t count = 0;
  first_.push_back(0);
  for (const TriangleMesh& mesh : meshes) {
    count += mesh.triangles.size();
    if (count >= (std::size_t{1} << 31)) {
      raise(Error::too_large, "the meshes have 2^31 triangles or more, which is more than kerf can number");
    }
    first_.push_back(static_cast<std::uint32_t>(count));
  }
}

}  // namespace kerf
