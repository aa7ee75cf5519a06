// Objects at their places, as many at a time as a vector of doubles has lanes.
#include "scene/placement.hpp"

#include <cstddef>
#include <cstdint>

#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/placement.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/fallback-inl.h"

#include "simd/doubles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace {

// A double in each lane.
struct Doubles {
  DoubleVector lanes;
  Doubles() = default;
  HWY_INLINE Doubles(DoubleVector x) : lanes(x) {}
  HWY_INLINE Doubles(double x) : lanes(dn::Set(DoubleTag(), x)) {}
};
HWY_INLINE Doubles operator+(Doubles a, Doubles b) {
  return dn::Add(a.lanes, b.lanes);
}
HWY_INLINE Doubles operator-(Doubles a, Doubles b) {
  return dn::Sub(a.lanes, b.lanes);
}
HWY_INLINE Doubles operator*(Doubles a, Doubles b) {
  return dn::Mul(a.lanes, b.lanes);
}
HWY_INLINE Doubles operator/(Doubles a, Doubles b) {
  return dn::Div(a.lanes, b.lanes);
}
HWY_INLINE Doubles smaller(Doubles a, Doubles b) {
  return dn::Min(a.lanes, b.lanes);
}
HWY_INLINE Doubles larger(Doubles a, Doubles b) {
  return dn::Max(a.lanes, b.lanes);
}
HWY_INLINE Doubles absolute(Doubles a) {
  return dn::Abs(a.lanes);
}
HWY_INLINE Doubles root(Doubles a) {
  return dn::Sqrt(a.lanes);
}
HWY_INLINE Doubles if_less(Doubles a, Doubles b, Doubles then, Doubles otherwise) {
  return dn::IfThenElse(dn::Lt(a.lanes, b.lanes), then.lanes, otherwise.lanes);
}
HWY_INLINE void store(Doubles a, double* to) {
  dn::Store(a.lanes, DoubleTag(), to);
}

// A map and the box of an object.
struct Inputs {
  Doubles m[3][4], lower[3], upper[3];
};

HWY_INLINE void find_center(const Inputs& in, Doubles (&center)[3]) {
  for (int j = 0; j < 3; ++j) {
    center[j] = if_less(Doubles(4.0) * (in.upper[j] - in.lower[j]),
                        absolute(in.lower[j]) + absolute(in.upper[j]), in.lower[j], 0.0);
  }
}

HWY_INLINE void place_center(const Inputs& in, const Doubles (&center)[3], Doubles (&at)[3]) {
  for (int i = 0; i < 3; ++i)
    at[i] = in.m[i][0] * center[0] + in.m[i][1] * center[1] + in.m[i][2] * center[2] + in.m[i][3];
}

HWY_INLINE void invert(const Doubles (&m)[3][4], Doubles (&inverse)[3][3]) {
  const auto minor = [&](int i, int j) HWY_ATTR {  // with its sign
    const int r = (i + 1) % 3, s = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
    return m[r][c] * m[s][d] - m[r][d] * m[s][c];
  };
  const Doubles determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) inverse[i][j] = minor(j, i) / determinant;
}

// S = A A^T has the square of it as its largest eigenvalue, and S^8 the sixteenth power. The largest sum of
// a row of a symmetric matrix is at least that of the eigenvalues, and at most the square root of 3 times
// that: 3^(1/32) = 1.035. Of symmetric matrices, the upper half is computed.
HWY_INLINE Doubles largest_singular_value(const Doubles (&a)[3][3]) {
  Doubles s[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) s[i][j] = a[i][0] * a[j][0] + a[i][1] * a[j][1] + a[i][2] * a[j][2];
  const Doubles trace = s[0][0] + s[1][1] + s[2][2], scale = Doubles(1.0) / trace;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) s[i][j] = s[i][j] * scale;  // the largest eigenvalue is one in [1/3, 1] now
  for (int squaring = 0; squaring < 3; ++squaring) {
    const auto of = [&](int i, int j) HWY_ATTR { return i <= j ? s[i][j] : s[j][i]; };
    Doubles squared[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j)
        squared[i][j] = of(i, 0) * of(0, j) + of(i, 1) * of(1, j) + of(i, 2) * of(2, j);
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) s[i][j] = squared[i][j];
  }
  const Doubles xy = absolute(s[0][1]), xz = absolute(s[0][2]), yz = absolute(s[1][2]);
  const Doubles largest =
      larger(larger(absolute(s[0][0]) + xy + xz, xy + absolute(s[1][1]) + yz), xz + yz + absolute(s[2][2]));
  return root(trace * root(root(root(largest)))) * Doubles(1.0 + 1e-6);
}

// The comparisons are false for what is not a number.
HWY_INLINE Doubles condition_of(const Doubles (&m)[3][4], const Doubles (&inverse)[3][3]) {
  constexpr double none = std::numeric_limits<double>::infinity();
  Doubles largest = 0.0;
  for (int i = 0; i < 3; ++i) {
    Doubles sum = 0.0;
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) sum = sum + absolute(m[i][k] * inverse[k][j]);
    largest = if_less(sum, PlacedObject::max_condition, larger(largest, sum), none);
  }
  return largest;
}

HWY_INLINE void box_of(const Inputs& in, Doubles (&low)[3], Doubles (&high)[3]) {
  Doubles center[3], at[3], lower[3], upper[3], reach[3];
  find_center(in, center);
  place_center(in, center, at);
  for (int j = 0; j < 3; ++j) {
    lower[j] = in.lower[j] - center[j];
    upper[j] = in.upper[j] - center[j];
    reach[j] = absolute(center[j]) + larger(absolute(lower[j]), absolute(upper[j]));
  }
  for (int i = 0; i < 3; ++i) {
    const auto& row = in.m[i];
    low[i] = high[i] = at[i];
    Doubles size = 0.0;
    for (int j = 0; j < 3; ++j) {
      const Doubles a = row[j] * lower[j], b = row[j] * upper[j];
      low[i] = low[i] + smaller(a, b);
      high[i] = high[i] + larger(a, b);
      size = size + absolute(row[j]) * reach[j];
    }
    // The last two are for the rounding here, to a float at last.
    const Doubles margin = Doubles(0x1p-16) * size + Doubles(0x1p-46) * (absolute(row[3]) + size) +
                           Doubles(0x1p-23) * larger(absolute(low[i]), absolute(high[i])) +
                           Doubles(double{std::numeric_limits<float>::min()});
    low[i] = low[i] - margin;
    high[i] = high[i] + margin;
  }
}

// Columns of as many numbers as there are lanes.
template <std::size_t count>
struct Columns {
  alignas(64) double of[count][double_lanes];
};

HWY_INLINE Inputs load(std::span<const PlacedBox> placed) {
  Columns<18> columns;
  for (std::size_t lane = 0; lane < double_lanes; ++lane) {
    const auto& [transform, bounds] = placed[std::min(lane, placed.size() - 1)];
    for (int i = 0; i < 12; ++i) columns.of[i][lane] = transform->rows[i / 4][i % 4];
    for (int j = 0; j < 3; ++j) {
      columns.of[12 + j][lane] = bounds->lower[j];
      columns.of[15 + j][lane] = bounds->upper[j];
    }
  }
  const DoubleTag tag;
  Inputs in;
  for (int i = 0; i < 12; ++i) in.m[i / 4][i % 4] = dn::Load(tag, columns.of[i]);
  for (int j = 0; j < 3; ++j) {
    in.lower[j] = dn::Load(tag, columns.of[12 + j]);
    in.upper[j] = dn::Load(tag, columns.of[15 + j]);
  }
  return in;
}

// Each of these takes as many as there are lanes, or fewer.
HWY_INLINE void box_few(std::span<const PlacedBox> placed, Box3f* to) {
  const Inputs in = load(placed);
  Doubles low[3], high[3];
  box_of(in, low, high);
  Columns<6> columns;
  for (int i = 0; i < 3; ++i) {
    store(low[i], columns.of[i]);
    store(high[i], columns.of[3 + i]);
  }
  for (std::size_t lane = 0; lane < placed.size(); ++lane) {
    for (int i = 0; i < 3; ++i) {
      to[lane].lower[i] = static_cast<float>(columns.of[i][lane]);
      to[lane].upper[i] = static_cast<float>(columns.of[3 + i][lane]);
    }
  }
}

HWY_INLINE void place_few(std::span<const PlacedBox> placed, Placement* const* placements,
                          double* conditions) {
  const Inputs in = load(placed);
  Doubles inverse[3][3], at[3], center[3];
  find_center(in, center);
  place_center(in, center, at);
  invert(in.m, inverse);
  Columns<17> columns;
  for (int i = 0; i < 9; ++i) store(inverse[i / 3][i % 3], columns.of[i]);
  for (int i = 0; i < 3; ++i) {
    store(at[i], columns.of[9 + i]);
    store(center[i], columns.of[12 + i]);
  }
  store(largest_singular_value(inverse), columns.of[15]);
  store(condition_of(in.m, inverse), columns.of[16]);
  for (std::size_t lane = 0; lane < placed.size(); ++lane) {
    Placement::Numbers numbers;
    for (int i = 0; i < 9; ++i) numbers.inverse[i / 3][i % 3] = columns.of[i][lane];
    for (int i = 0; i < 3; ++i) {
      numbers.at[i] = columns.of[9 + i][lane];
      numbers.center[i] = static_cast<float>(columns.of[12 + i][lane]);
    }
    numbers.stretch = static_cast<float>(columns.of[15][lane]);
    *placements[lane] = Placement(numbers);
    conditions[lane] = columns.of[16][lane];
  }
}

void objects(std::span<const PlacedBox> placed, Placement* const* placements, double* conditions) {
  for (std::size_t i = 0; i < placed.size(); i += double_lanes)
    place_few(placed.subspan(i, std::min(double_lanes, placed.size() - i)), placements + i, conditions + i);
}

void boxes(std::span<const PlacedBox> placed, Box3f* to) {
  for (std::size_t i = 0; i < placed.size(); i += double_lanes)
    box_few(placed.subspan(i, std::min(double_lanes, placed.size() - i)), to + i);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

HWY_EXPORT(objects);
HWY_EXPORT(boxes);

void place_objects(Target target, std::span<const PlacedBox> placed, Placement* const* placements,
                   double* conditions) {
  KERF_DISPATCH(objects, target)(placed, placements, conditions);
}
void place_boxes(Target target, std::span<const PlacedBox> placed, Box3f* to) {
  KERF_DISPATCH(boxes, target)(placed, to);
}

// With the instructions that every machine has.
PlacedObject place_object(const Transform& transform, const Box3f& bounds) {
  const PlacedBox placed{&transform, &bounds};
  PlacedObject object;
  Placement* const placement = &object.placement;
  HWY_STATIC_DISPATCH(objects)({&placed, 1}, &placement, &object.condition);
  return object;
}
Box3f place_box(const Transform& transform, const Box3f& bounds) {
  const PlacedBox placed{&transform, &bounds};
  Box3f box;
  HWY_STATIC_DISPATCH(boxes)({&placed, 1}, &box);
  return box;
}

}  // namespace kerf
#endif
