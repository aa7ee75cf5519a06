// What both ways of splitting before the build share: cutting while a size is above a threshold, and the
// threshold.
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
//   Part whole(const Reference&) const     a triangle as it is given
//   double size(const Part&) const         what is compared with the threshold
//   bool cut(const Part&, Part&, Part&)    the two halves; false if rounding leaves nothing between them
//   Box3f bounds(const Part&) const        what becomes a reference

/// No part comes from more cuts than this, one within the other. As many make parts of a 2^64th on average,
/// many more than there may be references; but where parts are as small as rounding, cutting one edge of a
/// triangle can lengthen another, and would never end.
constexpr int most_cuts = 64;

/// Visits the parts of `part` that a threshold leaves, until `visit` returns false; returns whether it never
/// did.
template <class Rule, class Part, class Visit>
bool visit_parts(const Rule& rule, const Part& part, double threshold, Visit& visit, int cuts = 0) {
  Part left, right;
  if (cuts == most_cuts || !(rule.size(part) > threshold) || !rule.cut(part, left, right)) return visit(part);
  return visit_parts(rule, left, threshold, visit, cuts + 1) &&
         visit_parts(rule, right, threshold, visit, cuts + 1);
}

/// Whether no more than `limit` parts are left of all references. Gives up counting as soon as there are
/// more.
template <class Rule>
bool fits(const Rule& rule, const std::vector<Reference>& references, double threshold, std::size_t limit) {
  std::atomic<std::size_t> total{references.size()};  // what is above one a reference is added
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

/// The smallest threshold under which there are at most `limit` parts, by bisection: the fewer the smaller
/// the threshold, since the cuts under a larger one are among those under a smaller. Of doubles that are not
/// negative the bits are in the same order, so that halving the range of bits takes as many steps as there
/// are bits.
template <class Rule>
double find_threshold(const Rule& rule, const std::vector<Reference>& references, std::size_t limit) {
  constexpr std::uint64_t infinity = std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity());
  // Thresholds that differ in no more than the last 24 of 52 bits are not told apart.
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

template <class Rule>
std::vector<Reference> split_before_build(const Rule& rule, std::vector<Reference> references,
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
