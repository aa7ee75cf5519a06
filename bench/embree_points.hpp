// Embree's point query on a scene, as its manual shows how to find a closest point; or nothing, where Embree
// is absent.
#pragma once

#include <memory>

#include "workbench/scene/scene.hpp"

namespace bench {

class EmbreePoints {
 public:
  explicit EmbreePoints(const workbench::Scene& scene);
  ~EmbreePoints();

  bool there() const { return state_ != nullptr; }
  float distance(const kerf::Vec3f& point) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace bench
