#include "workbench/scene/traced.hpp"

namespace workbench {

using namespace kerf;

Met Traced::met(const Hit& hit) const {
  const auto& [a, b, c] = scene_.triangles[hit.primitive];
  return {hit.t, hit.u, hit.v, {scene_.vertices[a], scene_.vertices[b], scene_.vertices[c]}};
}

Met Traced::met(const SceneHit& hit) const {
  return {hit.t, hit.u, hit.v, scene_.placed->triangle(hit.instance, hit.primitive)};
}

std::optional<Met> Traced::intersect(const Ray& ray) const {
  if (bvh_) {
    const auto hit = bvh_->intersect(ray);
    return hit ? std::optional(met(*hit)) : std::nullopt;
  }
  const auto hit = places_->intersect(ray);
  return hit ? std::optional(met(*hit)) : std::nullopt;
}

std::vector<std::optional<Met>> Traced::intersect(std::span<const Ray> rays) const {
  std::vector<std::optional<Met>> all(rays.size());
  const auto fill = [&](const auto& hits) {
    for (std::size_t i = 0; i < hits.size(); ++i)
      if (hits[i]) all[i] = met(hits[i]);
  };
  if (bvh_) {
    std::vector<Hit> hits(rays.size());
    bvh_->intersect(rays, hits);
    fill(hits);
  } else {
    std::vector<SceneHit> hits(rays.size());
    places_->intersect(rays, hits);
    fill(hits);
  }
  return all;
}

}  // namespace workbench
