// The meshes of a build, seen as one numbered row of triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <hwy/cache_control.h>
#include <kerf/layout.hpp>
#include <kerf/mesh.hpp>

#include "math/triangle.hpp"

namespace kerf {

/// Numbers the triangles of all meshes from 0, mesh after mesh. A view: the meshes must outlive it.
class Geometry {
 public:
  /// Checks counts only. Throws `Error::too_large` for 2^31 triangles or more.
  explicit Geometry(std::span<const TriangleMesh> meshes);

  std::size_t triangle_count() const { return first_.back(); }
  std::span<const TriangleMesh> meshes() const { return meshes_; }

  /// Triangle `id` of `0 .. triangle_count() - 1`; its indices must be in range.
  Triangle triangle(std::uint32_t id) const {
    const auto [primitive, mesh] = locate(id);
    return triangle_of(mesh, primitive);
  }

  /// Triangle `primitive` of mesh `mesh`.
  Triangle triangle_of(std::uint32_t mesh, std::uint32_t primitive) const {
    const auto [a, b, c] = meshes_[mesh].triangles[primitive].values;
    const auto& vertices = meshes_[mesh].vertices;
    return {vertex(vertices, a), vertex(vertices, b), vertex(vertices, c)};
  }

  /// Triangles and their vertices lie far from each other in memory. A caller that will read some triangles
  /// fetches the indices of all first, and then, once these have arrived, the vertices of all.
  void prefetch_indices(std::uint32_t id) const {
    const auto [primitive, mesh] = locate(id);
    const auto& triangles = meshes_[mesh].triangles;
    hwy::Prefetch(triangles.data() + primitive * triangles.stride());
  }
  void prefetch_corners(std::uint32_t id) const {
    const auto [primitive, mesh] = locate(id);
    const auto& vertices = meshes_[mesh].vertices;
    const auto indices = meshes_[mesh].triangles[primitive];
    for (const std::uint32_t index : indices.values)
      hwy::Prefetch(vertices.data() + index * vertices.stride());
  }

  PrimitiveId locate(std::uint32_t id) const { return kerf::locate(first_, id); }

  /// For mesh m, the number of its first triangle; one more entry ends the last mesh.
  std::span<const std::uint32_t> first_triangles() const { return first_; }

 private:
  static Vec3f vertex(const TripleView<float>& vertices, std::uint32_t i) {
    const auto [x, y, z] = vertices[i].values;
    return {x, y, z};
  }

  std::span<const TriangleMesh> meshes_;
  std::vector<std::uint32_t> first_;
};

}  // namespace kerf
