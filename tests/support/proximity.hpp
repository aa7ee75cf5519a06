// Hard triangles for questions about distances, and a hierarchy of them for each instruction set.
#pragma once

#include <random>
#include <utility>
#include <vector>

#include <kerf/build.hpp>

#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/targets.hpp"

namespace kerf {

inline adversarial::Soup sliver_soup(std::mt19937& random, float thinness) {
  std::vector<Triangle> slivers;
  while (slivers.size() < 60) {
    const Vec3f a = adversarial::uniform_point(random, 1.0f), b = adversarial::uniform_point(random, 1.0f);
    const Vec3f c =
        a + adversarial::uniform(random, 0.0f, 1.0f) * (b - a) + adversarial::uniform_point(random, thinness);
    if (!collinear(a, b, c)) slivers.push_back({a, b, c});
  }
  return adversarial::Soup(std::move(slivers));
}

/// A hierarchy for each instruction set of the machine.
inline std::vector<Bvh> build_for_each_target(const TriangleMesh& mesh) {
  std::vector<Bvh> hierarchies;
  kerf_tests::for_each_target(
      [&](const Target&) { hierarchies.push_back(build(mesh, spatial_splits_everywhere())); });
  return hierarchies;
}

}  // namespace kerf
