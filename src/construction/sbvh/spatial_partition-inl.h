// Spatial splits carried out in place.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_CONSTRUCTION_SBVH_SPATIAL_PARTITION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_CONSTRUCTION_SBVH_SPATIAL_PARTITION_INL_H
#undef KERF_CONSTRUCTION_SBVH_SPATIAL_PARTITION_INL_H
#else
#define KERF_CONSTRUCTION_SBVH_SPATIAL_PARTITION_INL_H
#endif

#include <hwy/highway.h>

#include "construction/sbvh/chop-inl.h"
#include "construction/sbvh/reference-inl.h"
#include "construction/sbvh/spatial_split-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

// Carries `split` out in place: references of the left child come first, those of the right child follow and
// run on into the slack where straddling references are divided. A straddling reference is kept whole on one
// side if that costs less (reference unsplitting, section 4.4 of the paper).
struct SpatialPartition {
  std::uint32_t left_count, right_count;
  ChildBoxes boxes, centroids;
};

HWY_NOINLINE SpatialPartition partition(const Geometry& geometry, Reference* references, std::uint32_t count,
                                        const SpatialSplit& split) {
  // Both children as they are if every straddling reference is divided. Unsplitting grows the box of one and
  // lowers the count of the other.
  SimdBox left_box = split.boxes.left, right_box = split.boxes.right;
  float left_count = split.left_count, right_count = split.right_count;
  std::uint32_t left_end = 0, right_begin = count, spare = count;
  ChildBoxes boxes{empty_box(), empty_box()}, centroids = boxes;
  const auto add_left = [&](const SimdBox& box) {
    boxes.left = merge(boxes.left, box);
    centroids.left = merge(centroids.left, centroid_box(box));
  };
  const auto add_right = [&](const SimdBox& box) {
    boxes.right = merge(boxes.right, box);
    centroids.right = merge(centroids.right, centroid_box(box));
  };
  while (left_end < right_begin) {
    Reference& reference = references[left_end];
    SpatialSplit::Side side = split.side_of(reference);
    if (side == SpatialSplit::both) {
      const ChildBoxes parts = chop(geometry, reference, split.axis, split.plane);
      if (is_empty(parts.right)) {
        side = SpatialSplit::left;
      } else if (is_empty(parts.left)) {
        side = SpatialSplit::right;
      } else {
        const SimdBox box = load_box(reference);
        const SimdBox grown_left = merge(left_box, box), grown_right = merge(right_box, box);
        const float left_area = half_area_of(left_box), right_area = half_area_of(right_box);
        const float divided = left_area * left_count + right_area * right_count;
        const float whole_left = half_area_of(grown_left) * left_count + right_area * (right_count - 1.0f);
        const float whole_right = left_area * (left_count - 1.0f) + half_area_of(grown_right) * right_count;
        if (right_count > 1.0f && whole_left <= divided && whole_left <= whole_right) {
          left_box = grown_left;
          right_count -= 1.0f;
          side = SpatialSplit::left;
        } else if (left_count > 1.0f && whole_right <= divided) {
          right_box = grown_right;
          left_count -= 1.0f;
          side = SpatialSplit::right;
        } else {
          const std::uint32_t primitive = reference.primitive;
          store_reference(parts.right, primitive, references[spare++]);
          add_right(parts.right);
          store_reference(parts.left, primitive, reference);
          side = SpatialSplit::left;
        }
      }
    }
    if (side == SpatialSplit::left) {
      add_left(load_box(reference));
      ++left_end;
    } else {
      add_right(load_box(reference));
      exchange(reference, references[--right_begin]);
    }
  }
  return {left_end, spare - left_end, boxes, centroids};
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
