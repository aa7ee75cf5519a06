#include "local_frame.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "construction/read_triangles.hpp"
#include "math/triangle.hpp"

namespace kerf {
namespace {

constexpr std::size_t triangles_per_task = 8192;
constexpr std::size_t nothing_wrong = ~std::size_t{0};

std::array<std::uint64_t, 3> indices_of(const IndexView& triangles, std::size_t i) {
  std::array<std::uint64_t, 3> indices;
  if (triangles.is_wide()) {
    std::copy_n(triangles.wide()[i].values, 3, indices.begin());
  } else {
    std::copy_n(triangles.narrow()[i].values, 3, indices.begin());
  }
  return indices;
}

Vec3d vertex(const DoubleMesh& mesh, std::uint64_t index) {
  const auto [x, y, z] = mesh.vertices[index].values;
  return {x, y, z};
}

bool is_in_range(const Vec3d& p) {  // false for what is not a number
  const double limit = coordinate_limit;
  return std::abs(p.x) < limit && std::abs(p.y) < limit && std::abs(p.z) < limit;
}

bool is_float(double x) {
  return static_cast<double>(static_cast<float>(x)) == x;
}

// What is known of the vertices that triangles use.
struct Extent {
  double lower[3] = {infinity, infinity, infinity}, upper[3] = {-infinity, -infinity, -infinity};
  bool are_floats = true;
  std::size_t wrong = nothing_wrong;  // number of the first triangle that cannot be read

  static constexpr double infinity = std::numeric_limits<double>::infinity();

  void add(const Vec3d& p) {
    const double coordinates[3] = {p.x, p.y, p.z};
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], coordinates[axis]);
      upper[axis] = std::max(upper[axis], coordinates[axis]);
      are_floats = are_floats && is_float(coordinates[axis]);
    }
  }

  friend Extent operator+(Extent a, const Extent& b) {
    for (int axis = 0; axis < 3; ++axis) {
      a.lower[axis] = std::min(a.lower[axis], b.lower[axis]);
      a.upper[axis] = std::max(a.upper[axis], b.upper[axis]);
    }
    a.are_floats = a.are_floats && b.are_floats;
    a.wrong = std::min(a.wrong, b.wrong);
    return a;
  }
};

Extent extent_of(const DoubleMesh& mesh, NonFinite non_finite) {
  return parallel_sum<Extent>(mesh.triangles.size(), triangles_per_task, [&](const auto& range) {
    Extent extent;
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const auto indices = indices_of(mesh.triangles, i);
      const bool in_mesh = *std::max_element(indices.begin(), indices.end()) < mesh.vertices.size();
      const bool readable = in_mesh && std::all_of(indices.begin(), indices.end(), [&](std::uint64_t index) {
                              return is_in_range(vertex(mesh, index));
                            });
      if (readable) {
        for (const std::uint64_t index : indices) extent.add(vertex(mesh, index));
      } else if (!in_mesh || non_finite == NonFinite::refuse) {
        extent.wrong = std::min(extent.wrong, i);
      }
    }
    return extent;
  });
}

// Throws for triangle `i` of mesh number `m`, in which something is wrong.
[[noreturn]] void explain(const DoubleMesh& mesh, std::size_t m, std::size_t i) {
  const auto indices = indices_of(mesh.triangles, i);
  for (const unsigned long long index : indices) {
    if (index >= mesh.vertices.size()) {
      raise(Error::index_out_of_range, "triangle %zu of mesh %zu names vertex %llu, but there are only %zu",
            i, m, index, mesh.vertices.size());
    }
    const Vec3d p = vertex(mesh, index);
    if (!is_in_range(p)) {
      raise(
          Error::non_finite_vertex,
          "vertex %llu of mesh %zu, used by triangle %zu, is (%g, %g, %g), but coordinates must be below %g",
          index, m, i, p.x, p.y, p.z, double{coordinate_limit});
    }
  }
  raise(Error::invalid_argument, "triangle %zu of mesh %zu cannot be read", i, m);
}

// Amid the vertices, and a multiple of a power of two of about a tenth of their extent: such a difference is
// exact in doubles, so that only the rounding to floats is left.
Vec3d choose_origin(const Extent& extent) {
  double size = 0.0, largest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(extent.lower[axis] <= extent.upper[axis])) return {};  // no vertices
    size = std::max(size, extent.upper[axis] - extent.lower[axis]);
    largest = std::max({largest, std::abs(extent.lower[axis]), std::abs(extent.upper[axis])});
  }
  if (extent.are_floats || largest <= size) return {};
  int exponent = 0;
  std::frexp(size, &exponent);
  const double step = std::ldexp(1.0, exponent - 4);
  const auto amid = [&](int axis) {
    const double middle = 0.5 * extent.lower[axis] + 0.5 * extent.upper[axis];
    return size == 0.0 ? middle : std::nearbyint(middle / step) * step + 0.0;
  };
  return {amid(0), amid(1), amid(2)};
}

// As the degeneracy of a triangle of floats is decided, see math/triangle.hpp.
bool has_area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  // p - q = high + low without rounding (Knuth 1969).
  struct Difference {
    double high, low;
    Difference(double p, double q) : high(p - q) {
      const double taken = p - high;
      low = (p - (high + taken)) + (taken - q);
    }
  };
  const auto add_product = [](ExactSum& sum, double p, double q) {
    const double product = p * q;
    sum.add(product);
    sum.add(std::fma(p, q, -product));
  };
  const auto differ = [&](const Difference& p, const Difference& q, const Difference& r,
                          const Difference& s) {
    const double pq = p.high * q.high, rs = r.high * s.high;
    constexpr double bound = 6.0 / 9007199254740992.0;
    if (std::abs(pq - rs) > bound * (std::abs(pq) + std::abs(rs))) return true;
    ExactSum sum;
    for (const double x : {p.high, p.low}) {
      for (const double y : {q.high, q.low}) add_product(sum, x, y);
    }
    for (const double x : {r.high, r.low}) {
      for (const double y : {s.high, s.low}) add_product(sum, -x, y);
    }
    return sum.sign() != 0;
  };
  const Difference ux(b.x, a.x), uy(b.y, a.y), uz(b.z, a.z), vx(c.x, a.x), vy(c.y, a.y), vz(c.z, a.z);
  return differ(uy, vz, uz, vy) || differ(uz, vx, ux, vz) || differ(ux, vy, uy, vx);
}

}  // namespace

LocalFrame::LocalFrame(std::span<const DoubleMesh> meshes, NonFinite non_finite)
    : meshes_(meshes), copies_(meshes.size()), local_(meshes.size()) {
  Extent all;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (meshes[m].vertices.size() > std::size_t{1} << 32) {
      raise(Error::too_large, "mesh %zu has more than 2^32 vertices, which is more than kerf can number", m);
    }
    const Extent extent = extent_of(meshes[m], non_finite);
    if (extent.wrong != nothing_wrong) explain(meshes[m], m, extent.wrong);
    all = all + extent;
  }
  origin_ = choose_origin(all);
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const DoubleMesh& from = meshes[m];
    Copy& copy = copies_[m];
    copy.vertices.resize(from.vertices.size());
    parallel_for_ranges(std::size_t{0}, copy.vertices.size(), triangles_per_task, [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const Vec3d p = vertex(from, i);
        copy.vertices[i] = {static_cast<float>(p.x - origin_.x), static_cast<float>(p.y - origin_.y),
                            static_cast<float>(p.z - origin_.z)};
      }
    });
    local_[m].vertices = copy.vertices;
    local_[m].mask = meshes_[m].mask;
    if (!from.triangles.is_wide()) {
      local_[m].triangles = from.triangles.narrow();
      continue;
    }
    copy.indices.resize(3 * from.triangles.size());
    parallel_for_ranges(std::size_t{0}, from.triangles.size(), triangles_per_task, [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const auto indices = indices_of(from.triangles, i);
        for (std::size_t k = 0; k < 3; ++k) copy.indices[3 * i + k] = static_cast<std::uint32_t>(indices[k]);
      }
    });
    local_[m].triangles = copy.indices;
  }
}

std::size_t LocalFrame::bytes() const {
  std::size_t bytes = 0;
  for (const Copy& copy : copies_) {
    bytes += copy.vertices.capacity() * sizeof(Vec3f) + copy.indices.capacity() * sizeof(std::uint32_t);
  }
  return bytes;
}

std::size_t LocalFrame::degenerate_by_rounding() const {
  std::size_t count = 0;
  const Geometry geometry(local_);
  for (std::uint32_t m = 0; m < meshes_.size(); ++m) {
    count +=
        parallel_sum<std::size_t>(meshes_[m].triangles.size(), triangles_per_task, [&](const auto& range) {
          std::size_t found = 0;
          for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const Triangle rounded = geometry.triangle_of(m, static_cast<std::uint32_t>(i));
            if (!is_finite(rounded.v0) || !is_finite(rounded.v1) || !is_finite(rounded.v2)) continue;
            if (!is_degenerate(rounded)) continue;
            const auto [a, b, c] = indices_of(meshes_[m].triangles, i);
            found += has_area(vertex(meshes_[m], a), vertex(meshes_[m], b), vertex(meshes_[m], c));
          }
          return found;
        });
  }
  return count;
}

}  // namespace kerf
