// What a `Bvh` holds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <kerf/bvh.hpp>

#include "base/shared_pointer.hpp"
#include "layout/refit.hpp"
#include "layout/wide_bvh.hpp"

namespace kerf {

struct Kernels;

/// For each triangle the leaf that it stands in, or one of them: found when it is first asked for.
class TriangleLeaves {
 public:
  TriangleLeaves() = default;
  TriangleLeaves(const TriangleLeaves&) {}  ///< a copy finds them itself
  TriangleLeaves& operator=(const TriangleLeaves&) = delete;

  /// The link of the leaf with triangle `id`; a node's link for a triangle in no leaf. Throws
  /// `std::bad_alloc`.
  ChildLink operator()(const WideBvh& bvh, std::size_t triangles, std::uint32_t id) const;

 private:
  mutable std::once_flag once_;
  mutable std::vector<ChildLink> leaves_;
};

/// Nothing in it changes while it is shared: a refit writes where there is no other handle.
struct Structure {
  WideBvh wide;
  std::vector<std::uint32_t> first_triangles;  ///< of each mesh, see `Layout`
  std::vector<std::uint32_t> masks;            ///< of each mesh; none where all have all bits
  BvhStatistics statistics;
  Vec3d origin;                      ///< of the local frame
  const Kernels* kernels = nullptr;  ///< what traces `wide`; null for a hierarchy of nothing
  TriangleLeaves triangle_leaves;
  bool writable = false;  ///< nodes and leaves are two arrays in memory of this process alone
  std::shared_ptr<const RefitBasis> refit_basis;  ///< made by the first refit
  std::vector<StandIn> stand_ins;                 ///< in leaves since the last one

  static const Structure& of(const Bvh& bvh) { return *SharedPointer<Structure>::in(bvh.structure_); }
  static std::shared_ptr<const Structure>& pointer_of(Bvh& bvh) {
    return SharedPointer<Structure>::in(bvh.structure_);
  }
  static Bvh share(std::shared_ptr<const Structure> structure) {
    return Bvh(SharedPointer<Structure>::share(std::move(structure)));
  }
};

/// The one way to a structure, for builds and for files. Chooses the kernels and fills in the statistics, but
/// for what only a build knows.
std::shared_ptr<Structure> make_structure(WideBvh wide, std::vector<std::uint32_t> first_triangles,
                                          std::size_t degenerate_triangles);

/// The triangle with number `id`, counted over all meshes.
inline PrimitiveId locate(const Structure& structure, std::uint32_t id) {
  return locate(structure.first_triangles, id);
}

/// Kernels number triangles over all meshes; users name them by mesh and primitive.
inline void name_triangle(const Structure& structure, Hit& hit) {
  const PrimitiveId id = locate(structure, hit.primitive);
  // A caller may load the hit at once: in the first mesh, what the kernel wrote stays as one store.
  if (id.primitive != hit.primitive) hit.primitive = id.primitive;
  hit.mesh = id.mesh;
}

}  // namespace kerf
