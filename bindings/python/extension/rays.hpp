// Rays as Python gives them.
#pragma once

#include <cstring>

#include "arrays.hpp"

namespace kerf::python {

/// Origins and directions, and what else there is of a ray, at any strides.
struct Rays {
  RayView view;

  Rays(const Triples& origins, const Triples& directions, const std::optional<Numbers<float>>& t_min,
       const std::optional<Numbers<float>>& t_max, const std::optional<Numbers<std::uint32_t>>& mask) {
    view.count = origins.shape(0);
    for (int axis = 0; axis < 3; ++axis) {
      view.origin[axis] = {origins.data() + axis * origins.stride(1), stride_in_bytes(origins, 0)};
      view.direction[axis] = {directions.data() + axis * directions.stride(1),
                              stride_in_bytes(directions, 0)};
    }
    view.t_min = column(t_min);
    view.t_max = column(t_max);
    view.mask = column(mask);
  }

  RayView slice(std::size_t first, std::size_t count) const {
    RayView slice = view;
    slice.count = count;
    for (int axis = 0; axis < 3; ++axis) {
      slice.origin[axis] = from(view.origin[axis], first);
      slice.direction[axis] = from(view.direction[axis], first);
    }
    slice.t_min = from(view.t_min, first);
    slice.t_max = from(view.t_max, first);
    slice.mask = from(view.mask, first);
    return slice;
  }

  Ray operator[](std::size_t i) const {
    const auto number = [i](const Column<const float>& column, float otherwise) {
      if (column.data == nullptr) return otherwise;
      float number;
      std::memcpy(&number, from(column, i).data, sizeof(number));
      return number;
    };
    Ray ray;
    for (int axis = 0; axis < 3; ++axis) {
      ray.origin[axis] = number(view.origin[axis], 0.0f);
      ray.direction[axis] = number(view.direction[axis], 0.0f);
    }
    ray.t_min = number(view.t_min, ray.t_min);
    ray.t_max = number(view.t_max, ray.t_max);
    return ray;
  }
};

}  // namespace kerf::python
