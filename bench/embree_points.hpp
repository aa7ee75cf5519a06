// Closest points by Embree's point query, used as its manual shows. Where Embree is absent, `available` is
// false.
#pragma once

#include <memory>

#include "workbench/scene/scene.hpp"

namespace bench {

class EmbreePoints {
 public:
  explicit EmbreePoints(const workbench::Scene& scene);
  ~EmbreePoints();

  bool available() const { return state_ != nullptr; }
  float distance(const kerf::Vec3f& point) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace bench
