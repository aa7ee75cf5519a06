// The loop over rays that are made on the spot, for kerf and its peers alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include <kerf/ray.hpp>

#include "workbench/base/vectors.hpp"
#include "workbench/bench/peers/ray_blocks.hpp"
#include "workbench/rays/rays.hpp"

namespace workbench {

/// One store of its own. Compilers join the stores of neighbouring fields in some programs and not in others;
/// a volatile one is never joined.
inline void write_field(float& field, float value) {
  static_cast<volatile float&>(field) = value;
}

inline void write_fields(float& x, float& y, float& z, const kerf::Vec3f& value) {
  write_field(x, value.x);
  write_field(y, value.y);
  write_field(z, value.z);
}

/// What a renderer does with a hit first: it finds the point from which it goes on.
class UsedHits {
 public:
  // A volatile store, so that no compiler leaves the sums out.
  ~UsedHits() { [[maybe_unused]] const volatile float kept = sum_.x + sum_.y + sum_.z + misses_; }

  void use(const MadeRay& ray, const std::optional<kerf::Hit>& hit, kerf::Hit& result) {
    if (hit) {
      sum_ = sum_ + (ray.origin + hit->t * ray.direction);
      result = *hit;
    } else {
      misses_ += 1.0f;
      result = {};
    }
  }
  void use(const MadeRay&, bool occluded, std::uint8_t& result) {
    if (!occluded) misses_ += 1.0f;
    result = occluded;
  }

 private:
  kerf::Vec3f sum_{};
  float misses_ = 0.0f;
};

/// Traces the rays of `set` from `first` on, one per element of `results`, in blocks (`for_ray_blocks`). For
/// each block `make_trace()` returns a function: `trace(ray, t_max)` traces one ray and returns its hit, a
/// `std::optional<kerf::Hit>`, or whether it is occluded.
template <class Result, class MakeTrace>
void for_made_rays(unsigned threads, const RaySet& set, std::size_t first, std::span<Result> results,
                   const MakeTrace& make_trace) {
  std::visit(
      [&](const auto& maker) {
        for_ray_blocks(threads, results.size(), [&](std::size_t begin, std::size_t end) {
          auto trace = make_trace();
          UsedHits used;
          for (std::size_t i = begin; i < end; ++i) {
            const MadeRay ray = maker.make(first + i);
            used.use(ray, trace(ray, maker.t_max), results[i]);
          }
        });
      },
      set.maker);
}

}  // namespace workbench
