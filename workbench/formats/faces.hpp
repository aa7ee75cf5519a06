// The faces of a file, triangles and polygons in the file's order, before their vertices need to be known.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <kerf/vec.hpp>

#include "workbench/formats/large_vector.hpp"

namespace workbench {

class Faces {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  std::size_t triangles() const { return triangles_.size(); }
  bool has_room_for(std::size_t triangles) const {
    return triangles_.capacity() - triangles_.size() >= triangles;
  }
  void reserve(std::size_t triangles) { reserve_large(triangles_, triangles); }
  void add(const Triangle& triangle) { triangles_.push_back(triangle); }
  void add(std::span<const Triangle> triangles) {
    triangles_.insert(triangles_.end(), triangles.begin(), triangles.end());
  }

  /// A face of any number of corners. One of fewer than three has no surface and is only counted.
  void add(std::span<const std::uint32_t> corners) {
    if (corners.size() == 3) {
      triangles_.push_back({corners[0], corners[1], corners[2]});
    } else if (corners.size() < 3) {
      ++without_surface_;
    } else {
      polygons_.push_back({triangles_.size(), corners_.size(), corners.size()});
      corners_.insert(corners_.end(), corners.begin(), corners.end());
    }
  }

  std::size_t without_surface() const { return without_surface_; }

  /// All faces as triangles, in order; the faces are empty afterwards. Every corner is an index into
  /// `vertices`. `crossing` is how many polygons had outlines that cross themselves.
  std::vector<Triangle> take_triangles(std::span<const kerf::Vec3f> vertices, std::size_t& crossing);

 private:
  struct Polygon {
    std::size_t triangles_before;  ///< in `triangles_`
    std::size_t first_corner, corners;
  };
  std::vector<Triangle> triangles_;
  std::vector<Polygon> polygons_;
  std::vector<std::uint32_t> corners_;
  std::size_t without_surface_ = 0;
};

}  // namespace workbench
