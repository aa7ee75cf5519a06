// The kernels of spatial queries, for the table of all kernels.
// Included once per instruction set: see simd/README.md.

#if defined(KERF_TRAVERSAL_QUERY_KERNELS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KERF_TRAVERSAL_QUERY_KERNELS_INL_H
#undef KERF_TRAVERSAL_QUERY_KERNELS_INL_H
#else
#define KERF_TRAVERSAL_QUERY_KERNELS_INL_H
#endif

#include <vector>

#include <hwy/highway.h>

#include "traversal/lines/prepared_line.hpp"
#include "traversal/points/near_triangle.hpp"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {

bool closest_triangle(const WideBvh& bvh, const Vec3f& point, double reach, NearTriangle& best);
void triangles_within(const WideBvh& bvh, const Vec3f& point, double reach, std::vector<NearTriangle>& found);
void visit_box(const WideBvh& bvh, const Box3f& box, void* visitor,
               bool (*visit)(void* visitor, ChildLink leaf, std::uint32_t place));
std::uint32_t line_meets(const WideNode& node, const PreparedLine& line, float* entry);
std::uint32_t line_may_cross(const WideBvh& bvh, ChildLink leaf, const PreparedLine& line);

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#endif
