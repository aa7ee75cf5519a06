// Hits of the meshes that a ray sees, and of those the hits that a caller accepts.
#include <cstdint>
#include <optional>

#include <kerf/bvh.hpp>

#include "base/id_set.hpp"
#include "base/out_of_memory.hpp"
#include "queries/batches.hpp"
#include "queries/ray_columns.hpp"
#include "structure.hpp"
#include "traversal/dispatch.hpp"

namespace kerf {
namespace {

// What the kernels ask about hits of one ray.
class Judge {
 public:
  Judge(const Structure& structure, Mask mask, void* context, bool (*accept)(void*, const Hit&))
      : structure_(structure), mask_(mask), context_(context), accept_(accept) {
    const BvhStatistics& all = structure.statistics;
    if (accept != nullptr &&
        all.references > all.triangles - all.degenerate_triangles - all.non_finite_triangles)
      asked_.emplace();
  }

  static bool accepts(void* judge, const Hit& hit) { return static_cast<Judge*>(judge)->counts(hit); }

 private:
  bool counts(Hit hit) {
    const std::uint32_t id = hit.primitive;
    name_triangle(structure_, hit);
    if (!structure_.masks.empty() && (structure_.masks[hit.mesh] & mask_.bits) == 0) return false;
    if (accept_ == nullptr) return true;
    // A triangle that stands in several leaves was refused in the first of them: one that was accepted is no
    // nearer than itself.
    if (asked_ && !report_out_of_memory([&] { return asked_->insert(id); })) return false;
    return accept_(context_, hit);
  }

  const Structure& structure_;
  Mask mask_;
  void* context_;
  bool (*accept_)(void*, const Hit&);
  std::optional<IdSet> asked_;
};

}  // namespace

std::optional<Hit> Bvh::intersect_filtered(const Ray& ray, Mask mask, void* context,
                                           bool (*accept)(void*, const Hit&)) const {
  const Structure& structure = *structure_;
  if (structure.wide.empty() || mask.bits == 0) return std::nullopt;
  Judge judge(structure, mask, context, accept);
  Hit hit;
  structure.kernels->closest_filtered(structure.wide, ray, &judge, Judge::accepts, hit);
  if (!hit) return std::nullopt;
  name_triangle(structure, hit);
  return hit;
}

bool Bvh::occluded_filtered(const Ray& ray, Mask mask, void* context,
                            bool (*accept)(void*, const Hit&)) const {
  const Structure& structure = *structure_;
  if (structure.wide.empty() || mask.bits == 0) return false;
  Judge judge(structure, mask, context, accept);
  return structure.kernels->any_filtered(structure.wide, ray, &judge, Judge::accepts);
}

namespace {

// A filter of many rays, asked about one of them.
struct OneOfMany {
  const void* context;
  bool (*accept)(const void* context, std::size_t ray, const Hit& hit);
  std::size_t ray;

  static bool accepts(void* one, const Hit& hit) {
    const OneOfMany& self = *static_cast<OneOfMany*>(one);
    return self.accept(self.context, self.ray, hit);
  }
};

// Calls `trace(i, ray, mask, context, accept)` for each ray, on as many threads as the options say.
template <class Trace>
void for_each_filtered(const RayView& rays, const BatchOptions& options, const void* context,
                       bool (*accept)(const void*, std::size_t, const Hit&), const Trace& trace) {
  for_each_batch(rays.count, rays_per_batch, options, [&](std::size_t begin, std::size_t count) {
    for (std::size_t i = begin; i < begin + count; ++i) {
      OneOfMany one{context, accept, i};
      trace(i, ray_at(rays, i), mask_at(rays, i), &one, accept == nullptr ? nullptr : OneOfMany::accepts);
    }
  });
}

}  // namespace

void Bvh::intersect_filtered(const RayView& rays, const HitView& hits, const BatchOptions& options,
                             const void* context, FilterOfMany accept) const {
  require_as_many(rays.count, hits.count, "as many hits as rays are needed");
  for_each_filtered(rays, options, context, accept,
                    [&](std::size_t i, const Ray& ray, Mask mask, void* one, auto* accepts) {
                      const auto hit = intersect_filtered(ray, mask, one, accepts);
                      write_hit(hits, i, hit.value_or(Hit{}));
                    });
}

void Bvh::occluded_filtered(const RayView& rays, const FlagView& occluded, const BatchOptions& options,
                            const void* context, FilterOfMany accept) const {
  require_as_many(rays.count, occluded.size(), "as many results as rays are needed");
  for_each_filtered(rays, options, context, accept,
                    [&](std::size_t i, const Ray& ray, Mask mask, void* one, auto* accepts) {
                      occluded.set(i, occluded_filtered(ray, mask, one, accepts));
                    });
}

}  // namespace kerf
