#include "construction/input.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <kerf/error.hpp>

#include "base/parallel.hpp"
#include "construction/read_triangles.hpp"

namespace kerf {
namespace {

template <class... Values>
[[noreturn]] void fail(Error::Code code, const char* format, Values... values) {
  char sentence[256];
  std::snprintf(sentence, sizeof sentence, format, values...);
  throw Error(code, sentence);
}

// Throws for triangle `id` of `geometry`, in which something is wrong.
[[noreturn]] void explain(const Geometry& geometry, std::uint32_t id) {
  const auto [i, m] = geometry.locate(id);
  const TriangleMesh& mesh = geometry.meshes()[m];
  for (const std::uint32_t index : mesh.triangles[i].values) {
    if (index >= mesh.vertices.size()) {
      fail(Error::index_out_of_range, "triangle %u of mesh %u names vertex %u, but there are only %zu", i, m,
           index, mesh.vertices.size());
    }
    const auto [x, y, z] = mesh.vertices[index].values;
    if (!is_finite({x, y, z})) {
      fail(Error::non_finite_vertex, "vertex %u of mesh %u, used by triangle %u, is (%g, %g, %g)", index, m,
           i, double{x}, double{y}, double{z});
    }
    if (std::max({std::abs(x), std::abs(y), std::abs(z)}) >= coordinate_limit) {
      fail(Error::non_finite_vertex,
           "vertex %u of mesh %u, used by triangle %u, is (%g, %g, %g), but coordinates must be below %g",
           index, m, i, double{x}, double{y}, double{z}, double{coordinate_limit});
    }
  }
  fail(Error::invalid_argument, "triangle %u of mesh %u cannot be read", i, m);
}

// What one task reads.
struct Block {
  TriangleRow row;  // its references are written from place `first_id` on
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

void check_options(const BuildOptions& options) {
  if (!(options.alpha >= 0.0f && options.alpha <= 1.0f)) {
    fail(Error::invalid_argument, "alpha is %g, but must be from 0 to 1", double{options.alpha});
  }
  if (!(options.max_reference_ratio >= 1.0f && options.max_reference_ratio <= 16.0f)) {
    fail(Error::invalid_argument, "max_reference_ratio is %g, but must be from 1 to 16",
         double{options.max_reference_ratio});
  }
  if (options.max_leaf_size < 1 || options.max_leaf_size > 8) {
    fail(Error::invalid_argument, "max_leaf_size is %u, but must be from 1 to 8", options.max_leaf_size);
  }
  if (options.builder != Builder::sbvh && options.builder != Builder::bvh &&
      options.builder != Builder::esc && options.builder != Builder::evh) {
    fail(Error::invalid_argument, "builder is %d, which names none", static_cast<int>(options.builder));
  }
}

ReferenceSummary write_references(const Geometry& geometry, Reference* references) {
  std::vector<Block> blocks = blocks_of(geometry);
  const Target target = choose_target();
  parallel_for(blocks.size(), [&](std::size_t i) {
    blocks[i].read = read_triangles(target, geometry, blocks[i].row, references + blocks[i].row.first_id);
  });
  ReferenceSummary summary;
  for (const auto& [row, read] : blocks) {
    if (read.wrong != ReadTriangles::nothing_wrong) explain(geometry, read.wrong);
    if (summary.count != row.first_id) {  // degenerate triangles were left out before this block
      std::copy_n(references + row.first_id, read.count, references + summary.count);
    }
    summary.count += read.count;
    summary.box = merge(summary.box, read.box);
    summary.doubled_centroids = merge(summary.doubled_centroids, read.doubled_centroids);
  }
  summary.degenerate_triangles = geometry.triangle_count() - summary.count;
  return summary;
}

Input make_references(const Geometry& geometry) {
  Input input;
  input.references.resize(geometry.triangle_count());
  const ReferenceSummary summary = write_references(geometry, input.references.data());
  input.references.resize(summary.count);
  input.degenerate_triangles = summary.degenerate_triangles;
  return input;
}

}  // namespace kerf
