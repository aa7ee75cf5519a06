// What rays of the tool go through to meet the triangles of a scene: a hierarchy of its mesh, or one over the
// places of its meshes.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <kerf/bvh.hpp>
#include <kerf/ray.hpp>
#include <kerf/scene.hpp>
#include <kerf/triangle.hpp>

#include "workbench/scene/scene.hpp"

namespace workbench {

/// Where a ray meets a triangle.
struct Met {
  float t, u, v;
  kerf::Triangle triangle;  ///< as it stands in the scene
};

/// Both handles and the scene must live as long as this.
class Traced {
 public:
  /// `bvh` is one of the scene's mesh.
  Traced(const Scene& scene, const kerf::Bvh& bvh) : scene_(scene), bvh_(&bvh) {}
  /// `places` is that of the scene's placed meshes.
  Traced(const Scene& scene, const kerf::Scene& places) : scene_(scene), places_(&places) {}

  std::optional<Met> intersect(const kerf::Ray& ray) const;
  bool occluded(const kerf::Ray& ray) const { return bvh_ ? bvh_->occluded(ray) : places_->occluded(ray); }
  kerf::Box3f bounds() const { return bvh_ ? bvh_->bounds() : places_->bounds(); }
  const Scene& scene() const { return scene_; }

  /// The same for many rays, on all cores.
  std::vector<std::optional<Met>> intersect(std::span<const kerf::Ray> rays) const;

 private:
  Met met(const kerf::Hit& hit) const;
  Met met(const kerf::SceneHit& hit) const;

  const Scene& scene_;
  const kerf::Bvh* bvh_ = nullptr;
  const kerf::Scene* places_ = nullptr;
};

}  // namespace workbench
