// Objects at places in scenes, and scenes in scenes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "support/adversarial.hpp"

namespace kerf_tests {

using kerf::Bvh;
using kerf::Instance;
using kerf::Mask;
using kerf::Scene;
using kerf::Transform;
using kerf::Triangle;
using kerf::Vec3f;

inline Transform scaled_and_moved(double scale, const Vec3f& by) {
  return {{{scale, 0, 0, by.x}, {0, scale, 0, by.y}, {0, 0, scale, by.z}}};
}

// Any invertible map: a turn, a scale along each axis and a shear.
inline Transform any_transform(std::mt19937& random, float size) {
  const double a = adversarial::uniform(random, 0, 6), b = adversarial::uniform(random, 0, 6);
  const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b);
  const double turn[3][3] = {{ca, -sa * cb, sa * sb}, {sa, ca * cb, -ca * sb}, {0, sb, cb}};
  const double shear[3][3] = {
      {adversarial::uniform(random, 0.3f, 2), adversarial::uniform(random, -0.5f, 0.5f), 0},
      {0, adversarial::uniform(random, 0.3f, 2), adversarial::uniform(random, -0.5f, 0.5f)},
      {0, 0, adversarial::uniform(random, 0.3f, 2)}};
  Transform transform;
  const Vec3f by = adversarial::uniform_point(random, 4.0f * size);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      transform.rows[i][j] = 0;
      for (int k = 0; k < 3; ++k) transform.rows[i][j] += double{size} * turn[i][k] * shear[k][j];
    }
    transform.rows[i][3] = by[i];
  }
  return transform;
}

// A corner in the scene, as the contract says it is moved: level by level in double precision, from the
// inside to the outside, then rounded once.
inline Vec3f moved_to_scene(const std::vector<Transform>& transforms, const Vec3f& corner) {
  double at[3] = {corner.x, corner.y, corner.z};
  for (auto level = transforms.rbegin(); level != transforms.rend(); ++level) {
    const double from[3] = {at[0], at[1], at[2]};
    for (int i = 0; i < 3; ++i) {
      at[i] = level->rows[i][0] * from[0];
      at[i] += level->rows[i][1] * from[1];
      at[i] += level->rows[i][2] * from[2];
      at[i] += level->rows[i][3];
    }
  }
  return {static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2])};
}
inline Triangle moved_to_scene(const std::vector<Transform>& transforms, const Triangle& t) {
  return {moved_to_scene(transforms, t.v0), moved_to_scene(transforms, t.v1),
          moved_to_scene(transforms, t.v2)};
}

// What stands in scenes in scenes, as (path, object, the transforms from the outside to the inside).
struct Leaf {
  std::vector<std::uint32_t> path;
  Bvh object;
  std::vector<Transform> transforms;
  std::vector<std::uint32_t> masks;

  bool is_seen(Mask mask) const {
    return std::all_of(masks.begin(), masks.end(),
                       [&](std::uint32_t bits) { return (bits & mask.bits) != 0; });
  }
};
inline void append_leaves(const Scene& scene, const Leaf& above, std::vector<Leaf>& leaves) {
  for (std::uint32_t i = 0; i < scene.instances().size(); ++i) {
    const Instance& instance = scene.instances()[i];
    Leaf leaf = above;
    leaf.path.push_back(i);
    leaf.transforms.push_back(instance.transform);
    leaf.masks.push_back(instance.mask.bits);
    leaf.object = instance.object;
    if (instance.scene.instances().empty()) {
      leaves.push_back(leaf);
    } else {
      append_leaves(instance.scene, leaf, leaves);
    }
  }
}

// A scene of objects, of scenes of objects, and of scenes of these, and things of nothing among them.
inline Scene scene_of_scenes(std::mt19937& random, const Bvh& object) {
  std::vector<Instance> inner, middle, outer;
  for (std::uint32_t i = 0; i < 7; ++i)
    inner.push_back({.object = i == 3 ? Bvh() : object, .transform = any_transform(random, 1), .mask = {i}});
  for (std::uint32_t i = 0; i < 5; ++i) {
    middle.push_back({.object = object, .transform = any_transform(random, 2), .mask = {~i}});
    if (i % 2 == 1) middle.back() = {.scene = kerf::build(inner), .transform = any_transform(random, 2)};
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    outer.push_back({.object = object, .transform = any_transform(random, 8)});
    if (i % 3 == 1)
      outer.back() = {.scene = kerf::build(middle), .transform = any_transform(random, 1), .number = i};
    if (i % 3 == 2)
      outer.back() = {.scene = kerf::build(inner), .transform = any_transform(random, 2), .mask = {3}};
  }
  return kerf::build(outer);
}

/// Those of the whole scene: what number i stands for is `leaves[i]`.
inline std::vector<Leaf> leaves_of(const Scene& scene) {
  std::vector<Leaf> leaves;
  append_leaves(scene, {}, leaves);
  return leaves;
}

}  // namespace kerf_tests
