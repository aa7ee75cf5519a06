// What is at a hit in a scene, without the caller's meshes.
#include <algorithm>
#include <cmath>
#include <optional>

#include <kerf/scene.hpp>

#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "base/raise.hpp"
#include "scene/chain.hpp"
#include "scene/placement.hpp"
#include "scene/places.hpp"

namespace kerf {
namespace {

// Calls `visit(object, chain, ray)` for the object of an instance, with the ray in its space. False if there
// is no such instance, or nothing in it.
template <class Visit>
bool visit_instance(const SceneStructure& scene, std::uint32_t number, const Chain* above, const Ray& ray,
                    const Visit& visit) {
  if (number >= scene.instance_count) return false;
  const std::uint32_t index = scene.index_of(number);
  const Instance& instance = scene.instances[index];
  const Chain chain{instance.transform, above};
  const bool has_scene = !instance.scene.instances().empty();
  const Box3f bounds = has_scene ? instance.scene.bounds() : instance.object.bounds();
  if (bounds.empty()) return false;
  // As the ray was moved when it was traced.
  const Ray local = place_object(instance.transform, bounds).placement.to_object(ray).ray;
  if (has_scene) {
    return visit_instance(SceneStructure::of(instance.scene), number - scene.numbers[index], &chain, local,
                          visit);
  }
  visit(instance.object, chain, local);
  return true;
}

double determinant(const Transform& transform) {
  const auto& m = transform.rows;
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

// The cross product of two moved edges is that of the edges, times the matrix of cofactors. It does not
// depend on how corners are rounded.
Vec3f moved_normal(const Chain& chain, const Vec3f& normal) {
  double n[3] = {normal.x, normal.y, normal.z};
  for (const Chain* level = &chain; level != nullptr; level = level->above) {
    const auto& m = level->transform.rows;
    double moved[3], largest = 0.0;
    for (int i = 0; i < 3; ++i) {
      moved[i] = 0.0;
      const int r = (i + 1) % 3, s = (i + 2) % 3;
      for (int j = 0; j < 3; ++j) {
        const int c = (j + 1) % 3, d = (j + 2) % 3;
        moved[i] += (m[r][c] * m[s][d] - m[r][d] * m[s][c]) * n[j];
      }
      largest = std::max(largest, std::abs(moved[i]));
    }
    for (double& component : moved) component /= largest;
    const double length = std::sqrt(moved[0] * moved[0] + moved[1] * moved[1] + moved[2] * moved[2]);
    for (int i = 0; i < 3; ++i) n[i] = moved[i] / length;
  }
  return {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
}

bool is_mirrored(const Chain& chain) {
  bool mirrored = false;
  for (const Chain* level = &chain; level != nullptr; level = level->above)
    mirrored = mirrored != (determinant(level->transform) < 0.0);
  return mirrored;
}

}  // namespace

std::optional<Triangle> Scene::triangle(const ScenePrimitiveId& id) const {
  const PlainFloatingPoint plain;
  return report_out_of_memory([&] {
    std::optional<Triangle> found;
    visit_instance(*structure_, id.instance, nullptr, Ray{},
                   [&](const Bvh& object, const Chain& chain, const Ray&) {
                     found = object.triangle({id.primitive, id.mesh});
                     if (found) found = chain(*found);
                   });
    return found;
  });
}

HitGeometry Scene::geometry(const Ray& ray, const SceneHit& hit) const {
  const PlainFloatingPoint plain;
  HitGeometry geometry;
  const bool is_there = visit_instance(
      *structure_, hit.instance, nullptr, ray, [&](const Bvh& object, const Chain& chain, const Ray& local) {
        geometry = object.geometry(local, {hit.t, hit.u, hit.v, hit.primitive, hit.mesh});
        geometry.triangle = chain(geometry.triangle);
        geometry.normal = moved_normal(chain, geometry.normal);
        geometry.front = geometry.front != is_mirrored(chain);
      });
  if (!is_there) raise(Error::invalid_argument, "a hit of no instance of this scene has no geometry");
  return geometry;
}

}  // namespace kerf
