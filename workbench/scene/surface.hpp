// What a mesh is as a surface: whether it is closed, and whether triangles stand in it twice.
#pragma once

#include <cstddef>

#include "workbench/scene/scene.hpp"

namespace workbench {

struct SurfaceFacts {
  /// Edges, from vertex to vertex by position, which no triangle beside goes the other way along. None: the
  /// surface is closed, and `contains` and `signed_distance` mean what they say.
  std::size_t open_edges = 0;

  /// Triangles with the same three vertices as one before them.
  std::size_t doubled_triangles = 0;

  bool closed() const { return open_edges == 0; }
};

/// Triangles of which two vertices are in one place are left out. In n log n steps.
SurfaceFacts surface_facts(const Scene& scene);

}  // namespace workbench
