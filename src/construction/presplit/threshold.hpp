// What both ways of splitting before the build share: parts are cut while their size is above a threshold,
// and the threshold is found by bisection.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "tree/reference.hpp"

namespace kerf {

// A `Rule` says what is cut, and where:
//
//   TrianglePart whole(const Reference&) const    a triangle as it is given
//   double size(const TrianglePart&) const        what is compared with the threshold
//   bool cut(const TrianglePart&, TrianglePart& left, TrianglePart& right) const
//                                                 false if rounding leaves nothing between the two halves
//   Box3f bounds(const TrianglePart&) const       the box of its reference

/// A part comes from at most this many nested cuts. Where parts are as small as rounding, cutting one edge of
/// a triangle can lengthen another, so that cutting would never end. 2^64 parts are many more than there may
/// be references, so that the limit takes effect there alone.
constexpr int max_cuts = 64;

/// Visits the parts into which a threshold cuts `part`, until `visit` returns false. Returns true if it never
/// did.
template <class Rule, class TrianglePart, class Visit>
bool visit_parts(const Rule& rule, const TrianglePart& part, double threshold, Visit& visit, int cuts = 0) {
  TrianglePart left, right;
  if (cuts == max_cuts || !(rule.size(part) > threshold) || !rule.cut(part, left, right)) return visit(part);
  return visit_parts(rule, left, threshold, visit, cuts + 1) &&
         visit_parts(rule, right, threshold, visit, cuts + 1);
}

/// Whether all references together are cut into at most `limit` parts. Stops counting as soon as there are
/// more.
template <class Rule>
bool fits(const Rule& rule, const std::vector<Reference>& references, double threshold, std::size_t limit) {
  std::atomic<std::size_t> total{references.size()};  // the first part of each; others are added
  parallel_for_ranges(std::size_t{0}, references.size(), 64, [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      std::size_t count = 0;
      const auto visit = [&](const auto&) {
        return ++count == 1 || total.fetch_add(1, std::memory_order_relaxed) < limit;
      };
      if (!visit_parts(rule, rule.whole(references[i]), threshold, visit)) return;
    }
  });
  return total <= limit;
}

/// The smallest threshold under which there are at most `limit` parts, by bisection. A smaller threshold
/// never makes fewer parts: all cuts under the larger one are made under the smaller one as well. Doubles
/// that are not negative are ordered as their bits are, so that bisecting the bits takes one step per bit.
template <class Rule>
double find_threshold(const Rule& rule, const std::vector<Reference>& references, std::size_t limit) {
  constexpr std::uint64_t infinity = std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity());
  // Thresholds that differ only in the last 24 of 52 bits count as equal.
  constexpr std::uint64_t step = std::uint64_t{1} << 24;
  std::uint64_t below = 0, above = infinity / step;
  while (above - below > 1) {
    const std::uint64_t middle = below + (above - below) / 2;
    if (fits(rule, references, std::bit_cast<double>(middle * step), limit)) {
      above = middle;
    } else {
      below = middle;
    }
  }
  return std::bit_cast<double>(above * step);
}

/// One reference for each part that the smallest such threshold makes; the references as they are if there is
/// no room for more.
template <class Rule>
std::vector<Reference> split_above_threshold(const Rule& rule, std::vector<Reference> references,
                                             std::size_t limit) {
  if (limit <= references.size()) return references;
  const double threshold = find_threshold(rule, references, limit);
  std::vector<Reference> parts;
  parts.reserve(limit);
  for (const Reference& reference : references) {
    const auto visit = [&](const auto& part) {
      parts.emplace_back(rule.bounds(part), reference.primitive);
      return true;
    };
    visit_parts(rule, rule.whole(reference), threshold, visit);
  }
  return parts;
}

}  // namespace kerf
