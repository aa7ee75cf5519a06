// An engine as the benchmark sees it: how to build with it, and how to trace what it built.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <kerf/mesh.hpp>
#include <kerf/ray.hpp>

#include "workbench/rays/rays.hpp"
#include "workbench/scene/placed.hpp"

namespace workbench {

/// One way of tracing a finished structure. The calls use the threads that the engine was made for.
struct Tracer {
  std::string engine;
  std::string mode;  ///< "single" (ray by ray), "batch" (spans) or "packet"
  std::function<void(std::span<const kerf::Ray>, std::span<kerf::Hit>)> intersect;
  std::function<void(std::span<const kerf::Ray>, std::span<std::uint8_t>)> occluded;

  /// The same for the rays from `begin` on, one per result, each of which is made right before it is traced
  /// and whose hit is used right behind. Empty where rays are only taken from arrays.
  std::function<void(const RaySet&, std::size_t begin, std::span<kerf::Hit>)> intersect_made = {};
  std::function<void(const RaySet&, std::size_t begin, std::span<std::uint8_t>)> occluded_made = {};
};

/// A structure that is ready to trace. The tracers own what they refer to.
struct Traceable {
  std::size_t bytes = 0;             ///< of the finished structure
  std::size_t build_peak_bytes = 0;  ///< the maximum that the build held at once, the structure included
  std::vector<Tracer> tracers;
};

/// A structure that follows vertices which move in the arrays it was made of.
struct Mover {
  std::string engine;
  std::string motion;                ///< "refit" or "rebuild"
  std::function<void()> next_frame;  ///< takes in where the vertices are now; this call is timed
  std::function<Tracer()> tracer;    ///< of the frame that was taken in last, ray by ray
};

struct Engine {
  std::string name;
  std::string version;
  std::string isa;  ///< the instruction set that it traces with

  /// From the caller's arrays to a structure that is ready to trace. This call is timed. It may read 16 bytes
  /// from the start of the last vertex.
  std::function<Traceable(const kerf::TriangleMesh&)> build;

  /// The same of meshes at places, each of which has one structure however often it stands somewhere.
  std::function<Traceable(const PlacedMeshes&)> build_placed = {};

  /// The ways in which it follows a mesh, whose arrays outlive them. It may read 16 bytes from the start of
  /// the last vertex.
  std::function<std::vector<Mover>(const kerf::TriangleMesh&)> movers = {};
};

}  // namespace workbench
