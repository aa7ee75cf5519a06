// Another library's hierarchy of the same triangles, traced with the same rays.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <kerf/ray.hpp>

namespace kerf::cuda {

class Peer {
 public:
  virtual ~Peer() = default;
  virtual std::string name() const = 0;
  virtual double build_ms() const = 0;
  /// Rays and results in memory of the device. Waits for nothing.
  virtual void closest(const Ray* rays, Hit* hits, std::uint32_t count) const = 0;
  virtual void any(const Ray* rays, std::uint8_t* results, std::uint32_t count) const = 0;
};

/// None where the bench was built without peers.
std::vector<std::unique_ptr<Peer>> make_peers(std::span<const Vec3f> vertices,
                                              std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace kerf::cuda
