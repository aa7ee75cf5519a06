#include "build/object_split.hpp"

#include <algorithm>
#include <array>

namespace kerf {
namespace {

// Twice the centroid: halving it would only cost time.
float doubled_centroid(const Reference& reference, int axis) {
  return reference.lower[axis] + reference.upper[axis];
}

std::uint32_t bin_of(float centroid, float origin, float scale) {
  return std::min(static_cast<std::uint32_t>((centroid - origin) * scale),
                  static_cast<std::uint32_t>(bin_count - 1));
}

using Order = std::array<std::uint32_t, sweep_limit>;

// The places of the references in the order of their centroids.
Order sorted(std::span<const Reference> references, int axis) {
  Order order;
  const auto count = static_cast<std::uint32_t>(references.size());
  std::array<float, sweep_limit> keys;
  for (std::uint32_t i = 0; i < count; ++i) {  // insertion keeps equals in their order
    const float key = doubled_centroid(references[i], axis);
    std::uint32_t place = i;
    for (; place > 0 && keys[place - 1] > key; --place) {
      keys[place] = keys[place - 1];
      order[place] = order[place - 1];
    }
    keys[place] = key;
    order[place] = i;
  }
  return order;
}

ObjectSplit sweep(std::span<const Reference> references) {
  const auto count = static_cast<std::uint32_t>(references.size());
  ObjectSplit best;
  best.swept = true;
  for (int axis = 0; axis < 3; ++axis) {
    const Order order = sorted(references, axis);
    std::array<Box3f, sweep_limit> right_boxes;  // of the references from a place on
    Box3f box;
    for (std::uint32_t i = count - 1; i > 0; --i) {
      box = merge(box, references[order[i]].bounds());
      right_boxes[i] = box;
    }
    box = {};
    for (std::uint32_t i = 1; i < count; ++i) {
      box = merge(box, references[order[i - 1]].bounds());
      const float cost =
          half_area(box) * static_cast<float>(i) + half_area(right_boxes[i]) * static_cast<float>(count - i);
      if (cost < best.cost) {
        best.cost = cost;
        best.axis = axis;
        best.first_right = i;
        best.left = box;
        best.right = right_boxes[i];
      }
    }
  }
  return best;
}

ObjectSplit find_binned(std::span<const Reference> references, const Box3f& centroids) {
  struct Bin {
    Box3f box;
    std::uint32_t count = 0;
  };
  std::array<std::array<Bin, bin_count>, 3> bins;
  Vec3f scale;
  for (int axis = 0; axis < 3; ++axis) {
    const float size = centroids.upper[axis] - centroids.lower[axis];
    scale[axis] = size > 0.0f ? static_cast<float>(bin_count) / size : 0.0f;
    if (scale[axis] > std::numeric_limits<float>::max()) scale[axis] = 0.0f;  // too thin to be parted by bins
  }
  for (const Reference& reference : references) {
    for (int axis = 0; axis < 3; ++axis) {
      Bin& bin = bins[static_cast<std::size_t>(axis)]
                     [bin_of(doubled_centroid(reference, axis), centroids.lower[axis], scale[axis])];
      bin.box = merge(bin.box, reference.bounds());
      ++bin.count;
    }
  }
  const auto total = static_cast<std::uint32_t>(references.size());
  ObjectSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    if (scale[axis] == 0.0f) continue;
    const auto& row = bins[static_cast<std::size_t>(axis)];
    std::array<Box3f, bin_count> right_boxes;
    Box3f box;
    for (std::uint32_t i = bin_count - 1; i > 0; --i) right_boxes[i] = box = merge(box, row[i].box);
    box = {};
    std::uint32_t left = 0;
    for (std::uint32_t i = 1; i < bin_count; ++i) {
      box = merge(box, row[i - 1].box);
      left += row[i - 1].count;
      if (left == 0 || left == total) continue;
      const float cost = half_area(box) * static_cast<float>(left) +
                         half_area(right_boxes[i]) * static_cast<float>(total - left);
      if (cost < best.cost) {
        best = {.cost = cost,
                .axis = axis,
                .origin = centroids.lower[axis],
                .scale = scale[axis],
                .first_right = i,
                .swept = false,
                .left = box,
                .right = right_boxes[i]};
      }
    }
  }
  return best;
}

}  // namespace

ObjectSplit find_object_split(std::span<const Reference> references, const Box3f& centroids) {
  return references.size() <= sweep_limit ? sweep(references) : find_binned(references, centroids);
}

std::uint32_t partition(std::span<Reference> references, const ObjectSplit& split) {
  if (split.swept) {
    const Order order = sorted(references, split.axis);
    std::array<Reference, sweep_limit> copy;
    std::copy(references.begin(), references.end(), copy.begin());
    for (std::size_t i = 0; i < references.size(); ++i) references[i] = copy[order[i]];
    return split.first_right;
  }
  const auto middle =
      std::partition(references.begin(), references.end(), [&split](const Reference& reference) {
        return bin_of(doubled_centroid(reference, split.axis), split.origin, split.scale) < split.first_right;
      });
  return static_cast<std::uint32_t>(middle - references.begin());
}

}  // namespace kerf
