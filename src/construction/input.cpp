#include "construction/input.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "construction/read_triangles.hpp"

namespace kerf {
namespace {

// What one task reads. Its references are written from place `row.first_id` on.
struct Block {
  TriangleRow row;
  ReadTriangles read;
};

std::vector<Block> blocks_of(const Geometry& geometry) {
  constexpr std::uint32_t block_size = 8192;
  std::vector<Block> blocks;
  for (std::uint32_t m = 0; m < geometry.meshes().size(); ++m) {
    const std::uint32_t first = geometry.first_triangles()[m],
                        count = geometry.first_triangles()[m + 1] - first;
    for (std::uint32_t begin = 0; begin < count; begin += block_size) {
      blocks.push_back({.row = {.mesh = m,
                                .begin = begin,
                                .end = std::min(begin + block_size, count),
                                .first_id = first + begin},
                        .read = {}});
    }
  }
  return blocks;
}

}  // namespace

void check_triangle(const Geometry& geometry, std::uint32_t id) {
  const auto [i, m] = geometry.locate(id);
  const TriangleMesh& mesh = geometry.meshes()[m];
  for (const std::uint32_t index : mesh.triangles[i].values) {
    if (index >= mesh.vertices.size()) {
      raise(Error::index_out_of_range, "triangle %u of mesh %u names vertex %u, but there are only %zu", i, m,
            index, mesh.vertices.size());
    }
    const auto [x, y, z] = mesh.vertices[index].values;
    if (!is_finite({x, y, z})) {
      raise(Error::non_finite_vertex, "vertex %u of mesh %u, used by triangle %u, is (%g, %g, %g)", index, m,
            i, double{x}, double{y}, double{z});
    }
    if (std::max({std::abs(x), std::abs(y), std::abs(z)}) >= coordinate_limit) {
      raise(Error::non_finite_vertex,
            "vertex %u of mesh %u, used by triangle %u, is (%g, %g, %g), but coordinates must be below %g",
            index, m, i, double{x}, double{y}, double{z}, double{coordinate_limit});
    }
  }
}

ReferenceSummary write_references(const Geometry& geometry, NonFinite non_finite, Reference* references) {
  std::vector<Block> blocks = blocks_of(geometry);
  const Target target = choose_target();
  parallel_for(blocks.size(), [&](std::size_t i) {
    const TriangleRow& row = blocks[i].row;
    blocks[i].read = read_triangles(target, geometry, row, non_finite, references + row.first_id);
  });
  ReferenceSummary summary;
  for (const auto& [row, read] : blocks) {
    if (read.wrong != ReadTriangles::nothing_wrong) check_triangle(geometry, read.wrong);  // throws
    if (summary.count != row.first_id) {  // earlier blocks left triangles out
      std::copy_n(references + row.first_id, read.count, references + summary.count);
    }
    summary.count += read.count;
    summary.non_finite_triangles += read.non_finite;
    summary.box = merge(summary.box, read.box);
    summary.doubled_centroids = merge(summary.doubled_centroids, read.doubled_centroids);
  }
  summary.degenerate_triangles = geometry.triangle_count() - summary.count - summary.non_finite_triangles;
  return summary;
}

Input make_references(const Geometry& geometry, NonFinite non_finite) {
  Input input;
  input.references.resize(geometry.triangle_count());
  const ReferenceSummary summary = write_references(geometry, non_finite, input.references.data());
  input.references.resize(summary.count);
  input.degenerate_triangles = summary.degenerate_triangles;
  input.non_finite_triangles = summary.non_finite_triangles;
  return input;
}

}  // namespace kerf
