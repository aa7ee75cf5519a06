#include "tree/measures/lcv.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "base/parallel.hpp"

namespace kerf {
namespace {

// The standard error of a deviation falls with the square root of the count: 2^16 lines leave under 0.5 %.
constexpr std::uint32_t line_count = 1u << 16;

// Lines are traced in rounds of doubling size until that many, or until they have met so many nodes: a line
// meets all of them where everything lies over one another. Beginnings of the sequence are sequences, too.
constexpr std::uint32_t first_round = 64;
constexpr std::uint64_t max_visits = std::uint64_t{1} << 28;

struct Line {
  std::array<double, 3> origin, inverse;  // of the direction
};

bool meets(const Line& line, const Box3f& box) {
  double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    double near = (box.lower[axis] - line.origin[k]) * line.inverse[k];
    double far = (box.upper[axis] - line.origin[k]) * line.inverse[k];
    if (near > far) std::swap(near, far);
    if (near > enter) enter = near;
    if (far < leave) leave = far;
  }
  return enter <= leave;
}

// Point `i` of a low-discrepancy sequence in the unit cube of five dimensions: multiples of the powers of the
// generalised golden ratio, the root of x^6 = x + 1 (Roberts 2018, "The Unreasonable Effectiveness of
// Quasirandom Sequences").
std::array<double, 5> sequence_point(std::uint32_t i) {
  constexpr double ratio = 1.1347241384015194;
  std::array<double, 5> point;
  double power = 1.0;
  for (double& coordinate : point) {
    power /= ratio;
    const double x = 0.5 + power * (i + 1.0);
    coordinate = x - std::floor(x);
  }
  return point;
}

// Line `i` from a point that is uniform on the surface of `box`, inward with the cosine distribution. Such
// lines are uniform among all lines that meet the box.
Line line_through(const Box3f& box, std::uint32_t i) {
  auto [face, a, b, radius, turn] = sequence_point(i);
  std::array<double, 3> size;
  for (int axis = 0; axis < 3; ++axis) {
    size[static_cast<std::size_t>(axis)] = double{box.upper[axis]} - box.lower[axis];
  }
  const std::array<double, 3> areas{size[1] * size[2], size[2] * size[0], size[0] * size[1]};
  face *= areas[0] + areas[1] + areas[2];
  std::size_t axis = 0;
  while (axis < 2 && face >= areas[axis]) face -= areas[axis++];
  const bool upper = 2.0 * face >= areas[axis];
  const std::size_t next = (axis + 1) % 3, last = (axis + 2) % 3;

  const std::array<double, 3> low{box.lower.x, box.lower.y, box.lower.z};
  Line line;
  line.origin[axis] = low[axis] + (upper ? size[axis] : 0.0);
  line.origin[next] = low[next] + a * size[next];
  line.origin[last] = low[last] + b * size[last];
  const double angle = 2.0 * std::numbers::pi * turn;
  line.inverse[axis] = (upper ? -1.0 : 1.0) / std::sqrt(1.0 - radius);
  line.inverse[next] = 1.0 / (std::sqrt(radius) * std::cos(angle));
  line.inverse[last] = 1.0 / (std::sqrt(radius) * std::sin(angle));
  return line;
}

std::uint64_t count_leaves(const BinaryTree& tree, const Line& line, std::vector<std::uint32_t>& stack,
                           std::uint64_t& visits) {
  std::uint64_t count = 0;
  stack.assign(1, 0);
  while (!stack.empty()) {
    const BinaryNode& node = tree.nodes[stack.back()];
    stack.pop_back();
    ++visits;
    if (!meets(line, node.bounds)) continue;
    if (node.is_leaf()) {
      ++count;
    } else {
      stack.push_back(node.left());
      stack.push_back(node.right());
    }
  }
  return count;
}

}  // namespace

double leaf_count_variability(const BinaryTree& tree) {
  if (tree.empty()) return 0.0;
  struct Sum {
    std::uint64_t leaves = 0;
    std::uint64_t squares = 0;
    std::uint64_t visits = 0;

    Sum operator+(const Sum& other) const {
      return {leaves + other.leaves, squares + other.squares, visits + other.visits};
    }
  };
  const auto of_lines = [&tree](std::uint32_t begin, std::uint32_t end) {
    return parallel_sum<Sum>(end - begin, first_round / 4, [&tree, begin](const auto& range) {
      Sum sum;
      std::vector<std::uint32_t> stack;
      for (std::uint32_t i = range.begin(); i != range.end(); ++i) {
        const Line line = line_through(tree.nodes[0].bounds, begin + i);
        const std::uint64_t count = count_leaves(tree, line, stack, sum.visits);
        sum.leaves += count;
        sum.squares += count * count;
      }
      return sum;
    });
  };
  Sum sum = of_lines(0, first_round);
  std::uint32_t lines = first_round;
  for (; lines < line_count && 2 * sum.visits < max_visits; lines *= 2)
    sum = sum + of_lines(lines, 2 * lines);
  const double mean = static_cast<double>(sum.leaves) / lines;
  return std::sqrt(std::max(0.0, static_cast<double>(sum.squares) / lines - mean * mean));
}

}  // namespace kerf
