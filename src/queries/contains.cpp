#include "base/fp_environment.hpp"
#include "base/out_of_memory.hpp"
#include "queries/crossings.hpp"
#include "queries/visit_box.hpp"

namespace kerf {
namespace {

// Any direction gives the same answer. One that is oblique to all coordinate planes leaves few decisions to
// exact arithmetic in scenes with walls along the axes.
constexpr Vec3f oblique{0.8571f, 0.3163f, 0.4067f};

bool on_surface(const Structure& structure, const Vec3f& point) {
  bool found = false;
  visit_box(structure, Box3f{point, point}, [&](std::uint32_t, const Triangle& triangle) {
    found = lies_on(point, triangle);
    return !found;
  });
  return found;
}

}  // namespace

bool Bvh::contains(const Vec3f& point) const {
  const PlainFloatingPoint plain;
  if (!kerf::contains(structure_->wide.bounds, Box3f{point, point})) return false;
  return report_out_of_memory([&] {
    if (on_surface(*structure_, point)) return true;
    bool inside = false;
    for_each_crossing(*structure_, {.origin = point, .direction = oblique}, [&](std::uint32_t, const Hit&) {
      inside = !inside;
      return true;
    });
    return inside;
  });
}

float Bvh::signed_distance(const Vec3f& point) const {
  const auto closest = closest_point(point);
  if (!closest) return std::numeric_limits<float>::infinity();
  return contains(point) ? -closest->distance : closest->distance;
}

}  // namespace kerf
