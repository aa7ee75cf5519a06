// Rays made one at a time, as a renderer makes them, from what it has at hand by then. A ray costs a few
// multiplications and additions: what costs more, roots and random numbers, was computed before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <kerf/vec.hpp>

#include "workbench/base/vectors.hpp"
#include "workbench/rays/camera.hpp"

namespace workbench {

struct MadeRay {
  kerf::Vec3f origin, direction;
};

/// Rays through points of pictures.
struct CameraRays {
  struct Sample {
    float x, y;            ///< the point of the picture, in pixels
    float scale;           ///< 1 over the distance of that point from the camera
    std::uint32_t camera;  ///< its place in `cameras`
  };

  std::vector<Camera> cameras;
  std::vector<Sample> samples;  ///< one per ray
  float t_max = std::numeric_limits<float>::infinity();

  MadeRay make(std::size_t i) const {
    const Sample& sample = samples[i];
    const Camera& camera = cameras[sample.camera];
    return {camera.position(), sample.scale * camera.way_to(sample.x, sample.y)};
  }
};

/// Rays from surface points that were hit.
struct SurfaceRays {
  struct Sample {
    kerf::Vec3f position;
    kerf::Vec3f normal;   ///< unit length
    kerf::Vec3f tangent;  ///< what the direction has along the surface
    float height;         ///< what it has along the normal
  };

  std::vector<Sample> samples;  ///< one per ray
  float offset = 0.0f;          ///< of origins from the surface
  float t_max = std::numeric_limits<float>::infinity();

  MadeRay make(std::size_t i) const {
    const Sample& sample = samples[i];
    return {sample.position + offset * sample.normal, sample.tangent + sample.height * sample.normal};
  }
};

}  // namespace workbench
