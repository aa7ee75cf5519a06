// Random triangles and rays for the tracing tests.
#pragma once

#include <random>
#include <vector>

#include <kerf/kerf.hpp>

#include "math/vec3f.hpp"

struct TriangleSoup {
  std::vector<kerf::Vec3f> vertices;
  std::vector<std::uint32_t> triangles;

  kerf::TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
};

inline kerf::Vec3f random_point(std::mt19937& random, float scale = 1.0f) {
  std::uniform_real_distribution<float> uniform(-scale, scale);
  const float x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

/// Triangles round random points, long in one direction and `thinness` as wide.
inline TriangleSoup random_soup(std::mt19937& random, std::size_t count, float size, float thinness) {
  TriangleSoup soup;
  for (std::uint32_t i = 0; i < 3 * count; i += 3) {
    const kerf::Vec3f center = random_point(random), along = random_point(random, size);
    const kerf::Vec3f corners[] = {center, center + along, center + random_point(random, size * thinness)};
    for (std::uint32_t k = 0; k < 3; ++k) {
      soup.vertices.push_back(corners[k]);
      soup.triangles.push_back(i + k);
    }
  }
  return soup;
}

/// `soup` times `factor`.
inline TriangleSoup scaled(TriangleSoup soup, float factor) {
  for (kerf::Vec3f& v : soup.vertices) v = v * factor;
  return soup;
}
