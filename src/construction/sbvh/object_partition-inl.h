// Object splits carried out in place.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_CONSTRUCTION_SBVH_OBJECT_PARTITION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_CONSTRUCTION_SBVH_OBJECT_PARTITION_INL_H
#undef KERF_CONSTRUCTION_SBVH_OBJECT_PARTITION_INL_H
#else
#define KERF_CONSTRUCTION_SBVH_OBJECT_PARTITION_INL_H
#endif

#include <algorithm>
#include <cstddef>

#include <hwy/highway.h>

#include "construction/sbvh/object_split-inl.h"
#include "construction/sbvh/object_sweep-inl.h"
#include "construction/sbvh/reference-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

// Decides which side references go to, and collects the boxes of each side.
struct Sides {
  ChildBoxes boxes;
  ChildBoxes centroids;

  HWY_INLINE bool add(const Reference& reference, const ObjectSplit& split) {
    const SimdBox box = load_box(reference), centroid = centroid_box(box);
    const float place = (doubled_centroid(reference, split.axis) - split.origin) * split.scale;
    const BoxMask is_left = box_mask(place, split.threshold);
    boxes.left = merge_if(is_left, boxes.left, box);
    boxes.right = merge_if_not(is_left, boxes.right, box);
    centroids.left = merge_if(is_left, centroids.left, centroid);
    centroids.right = merge_if_not(is_left, centroids.right, centroid);
    return place < split.threshold;
  }
};

// For few references: those that go right wait in a buffer. There is no branch: each reference is written to
// both sides, and only the side where it belongs advances.
constexpr std::uint32_t buffered_limit = 256;

HWY_INLINE std::uint32_t partition_buffered(Reference* references, std::uint32_t count,
                                            const ObjectSplit& split, Sides& sides) {
  alignas(32) std::byte memory[buffered_limit * sizeof(Reference)];
  auto* const right = reinterpret_cast<Reference*>(memory);
  std::uint32_t left_count = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const bool is_left = sides.add(references[i], split);
    const SimdBox here = load_whole(references[i]);
    store_whole(here, right[i - left_count]);
    store_whole(here, references[left_count]);
    left_count += is_left ? 1 : 0;
  }
  std::copy_n(right, count - left_count, references + left_count);
  return left_count;
}

// For many references: those on the wrong side are listed, one block from either end at a time, and exchanged
// in pairs (Edelkamp & Weiss 2016, "BlockQuicksort").
HWY_INLINE std::uint32_t partition_in_blocks(Reference* references, std::uint32_t count,
                                             const ObjectSplit& split, Sides& sides) {
  constexpr std::uint32_t block = 128;
  std::uint8_t wrong_left[block], wrong_right[block];
  std::uint32_t begin = 0, end = count, left_first = 0, left_last = 0, right_first = 0, right_last = 0;
  while (end - begin > 2 * block) {
    if (left_first == left_last) {
      left_first = left_last = 0;
      for (std::uint32_t i = 0; i < block; ++i) {
        wrong_left[left_last] = static_cast<std::uint8_t>(i);
        left_last += sides.add(references[begin + i], split) ? 0 : 1;
      }
    }
    if (right_first == right_last) {
      right_first = right_last = 0;
      for (std::uint32_t i = 0; i < block; ++i) {
        wrong_right[right_last] = static_cast<std::uint8_t>(i);
        right_last += sides.add(references[end - 1 - i], split) ? 1 : 0;
      }
    }
    const std::uint32_t pairs = std::min(left_last - left_first, right_last - right_first);
    for (std::uint32_t i = 0; i < pairs; ++i) {
      exchange(references[begin + wrong_left[left_first + i]],
               references[end - 1 - wrong_right[right_first + i]]);
    }
    left_first += pairs;
    right_first += pairs;
    if (left_first == left_last) begin += block;
    if (right_first == right_last) end -= block;
  }
  // At most one of the two blocks is left half done. Its references are added to the boxes a second time,
  // which changes no minimum.
  return begin + partition_buffered(references + begin, end - begin, split, sides);
}

// Reorders in place: references that go left come first.
struct Partition {
  std::uint32_t left_count;
  ChildBoxes boxes, centroids;
};

HWY_NOINLINE Partition partition(Reference* references, std::uint32_t count, const ObjectSplit& split) {
  Sides sides{{empty_box(), empty_box()}, {empty_box(), empty_box()}};
  const std::uint32_t left_count = count <= buffered_limit
                                       ? partition_buffered(references, count, split, sides)
                                       : partition_in_blocks(references, count, split, sides);
  return {left_count, sides.boxes, sides.centroids};
}

// The same for at most `sweep_limit` references, without the bounds of the centroids, which nothing needs
// there.
HWY_INLINE std::uint32_t partition_few(Reference* references, std::uint32_t count, const ObjectSplit& split,
                                       ChildBoxes& boxes) {
  boxes = {empty_box(), empty_box()};
  alignas(32) std::byte memory[sweep_limit * sizeof(Reference)];
  auto* const right = reinterpret_cast<Reference*>(memory);
  std::uint32_t left_count = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const SimdBox box = load_box(references[i]);
    const float key = doubled_centroid(references[i], split.axis);
    const BoxMask is_left = box_mask(key, split.threshold);
    boxes.left = merge_if(is_left, boxes.left, box);
    boxes.right = merge_if_not(is_left, boxes.right, box);
    const SimdBox here = load_whole(references[i]);
    store_whole(here, right[i - left_count]);
    store_whole(here, references[left_count]);
    left_count += key < split.threshold ? 1 : 0;
  }
  std::copy_n(right, count - left_count, references + left_count);
  return left_count;
}

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
