#include "build/input.hpp"

#include <cstdio>
#include <kerf/error.hpp>

namespace kerf {
namespace {

template <class... Values>
[[noreturn]] void fail(Error::Code code, const char* format, Values... values) {
  char sentence[256];
  std::snprintf(sentence, sizeof sentence, format, values...);
  throw Error(code, sentence);
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

Input make_references(const Geometry& geometry) {
  Input input;
  input.references.reserve(geometry.triangle_count());
  std::uint32_t id = 0;
  for (std::size_t m = 0; m < geometry.meshes().size(); ++m) {
    const TriangleMesh& mesh = geometry.meshes()[m];
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i, ++id) {
      const auto indices = mesh.triangles[i];
      for (const std::uint32_t index : indices.values) {
        if (index >= mesh.vertices.size()) {
          fail(Error::index_out_of_range, "triangle %zu of mesh %zu names vertex %u, but there are only %zu",
               i, m, index, mesh.vertices.size());
        }
        const auto [x, y, z] = mesh.vertices[index].values;
        if (!is_finite({x, y, z})) {
          fail(Error::non_finite_vertex, "vertex %u of mesh %zu, used by triangle %zu, is (%g, %g, %g)",
               index, m, i, double{x}, double{y}, double{z});
        }
      }
      const Triangle triangle = geometry.triangle(id);
      if (is_degenerate(triangle)) {
        ++input.degenerate_triangles;
      } else {
        input.references.emplace_back(bounds_of(triangle), id);
      }
    }
  }
  return input;
}

}  // namespace kerf
