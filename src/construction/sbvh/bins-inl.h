// Bins on three axes, which object splits fill by centroids and spatial splits by where boxes begin and end.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_CONSTRUCTION_SBVH_BINS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_CONSTRUCTION_SBVH_BINS_INL_H
#undef KERF_CONSTRUCTION_SBVH_BINS_INL_H
#else
#define KERF_CONSTRUCTION_SBVH_BINS_INL_H
#endif

#include <cstddef>
#include <cstring>

#include <hwy/highway.h>

#include "simd/box-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

constexpr int max_bin_count = 32;

// A bin's number of references stands in the unused fourth lane of its box, so that both are one load and one
// store. It is encoded as a positive float, so that the minimum that merges boxes leaves it alone: the
// smallest normal float stands for 0, the next for 1. (Denormals are slow on some machines.)
constexpr std::int32_t no_references = 0x00800000;

// Two bins, for as long as vectors may be.
alignas(64) constexpr std::uint32_t empty_bin_lanes[16] = {
    0x7f800000, 0x7f800000, 0x7f800000, no_references, 0x7f800000, 0x7f800000, 0x7f800000, 0x7f800000,
    0x7f800000, 0x7f800000, 0x7f800000, no_references, 0x7f800000, 0x7f800000, 0x7f800000, 0x7f800000};

// The bins of each axis lie in a row.
struct alignas(64) Bins {
  float boxes[3][max_bin_count][8];

  HWY_INLINE SimdBox box(int axis, int i) const { return load_bin(boxes[axis][i]); }

  HWY_INLINE std::int32_t count(int axis, int i) const {
    std::int32_t lane;
    std::memcpy(&lane, boxes[axis][i] + 3, sizeof lane);
    return lane - no_references;
  }

  // The counts of the i-th bin of each axis, in three lanes.
  HWY_INLINE hn::Vec<IntTag4> counts(int i) const {
    const Float4 x = hn::Load(f32x4, boxes[0][i]), y = hn::Load(f32x4, boxes[1][i]),
                 z = hn::Load(f32x4, boxes[2][i]);
    const Float4 xz = hn::InterleaveUpper(f32x4, x, z), yy = hn::InterleaveUpper(f32x4, y, y);
    return hn::Sub(hn::BitCast(i32x4, hn::InterleaveUpper(f32x4, xz, yy)), hn::Set(i32x4, no_references));
  }
};

HWY_INLINE void clear(Bins& bins, int bin_count) {
  using Lanes = hn::CappedTag<float, 16>;
  constexpr Lanes lanes;
  constexpr int width = static_cast<int>(hn::MaxLanes(Lanes()));
  const auto* const none = reinterpret_cast<const float*>(empty_bin_lanes);
  for (int axis = 0; axis < 3; ++axis) {
    for (float *bin = bins.boxes[axis][0], *end = bin + 8 * bin_count; bin != end; bin += 16) {
      for (int i = 0; i < 16; i += width) hn::Store(hn::Load(lanes, none + i), lanes, bin + i);
    }
  }
}

// Adds all that is in `other`.
HWY_INLINE void add(Bins& bins, const Bins& other, int bin_count) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < bin_count; ++i) {
      const std::int32_t lane = bins.count(axis, i) + other.count(axis, i) + no_references;
      store_bin(merge(bins.box(axis, i), other.box(axis, i)), bins.boxes[axis][i]);
      std::memcpy(bins.boxes[axis][i] + 3, &lane, sizeof lane);
    }
  }
}

// The lowest 16 bits of the float 2^18 + i are the distance in bytes from the first bin to bin i: a unit in
// the last place is 2^-5.
constexpr float bin_magic = 262144.0f;
static_assert(sizeof(Bins::boxes[0][0]) == 1 << 5);

// Adds a box, which `counted_once` has prepared, to one bin per axis. `places` are the bins' numbers with
// `bin_magic` added.
HWY_INLINE void add(Bins& bins, const float* places, const SimdBox& box) {
  for (int axis = 0; axis < 3; ++axis) {
    std::uint32_t bits;
    std::memcpy(&bits, places + axis, sizeof bits);
    auto* const first = reinterpret_cast<std::byte*>(bins.boxes[axis]);
    auto* const bin = reinterpret_cast<float*>(first + static_cast<std::uint16_t>(bits));
    store_bin(count_one(merge(load_bin(bin), box)), bin);
  }
}

// Bins are found this many references ahead of the addition. Their numbers pass from vectors to addresses
// through memory, and while an addition waits for the one before, others can be found.
constexpr std::uint32_t binning_lead = 8;

// Calls `find(i, slot)` and, later, `add(i, slot)` for each i of `0 .. count - 1`; slots are below
// `binning_lead`.
template <class Find, class Add>
HWY_INLINE void bin_ahead(std::uint32_t count, const Find& find, const Add& add) {
  const std::uint32_t lead = HWY_MIN(binning_lead, count);
  for (std::uint32_t i = 0; i < lead; ++i) find(i, i);
  for (std::uint32_t i = 0; i < count - lead; ++i) {
    add(i, i % binning_lead);
    find(i + lead, i % binning_lead);
  }
  for (std::uint32_t i = count - lead; i < count; ++i) add(i, i % binning_lead);
}

// From coordinates to bins on three axes. The scale of an axis that is too short to be divided is 0.
struct BinMapping {
  alignas(16) float origin[4];
  alignas(16) float scale[4];

  BinMapping(const Box3f& box, int bins) {
    for (int axis = 0; axis < 3; ++axis) {
      const float size = box.upper[axis] - box.lower[axis];
      const float s = static_cast<float>(bins) / size;
      origin[axis] = box.lower[axis];
      scale[axis] = size > 0.0f && s <= std::numeric_limits<float>::max() ? s : 0.0f;
    }
    origin[3] = scale[3] = 0.0f;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
