// The build of the device, run on the host.
#include <numeric>

#include <gtest/gtest.h>

#include "../src/refit.hpp"
#include "../src/sort_by_key.hpp"
#include "support.hpp"

namespace kerf::cuda {
namespace {

// A floor of long thin triangles that lie askew, under a field of small ones: where splits pay.
struct Slats {
  std::vector<Vec3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  Slats() {
    std::mt19937 random(5);
    const auto uniform = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
    for (std::uint32_t i = 0; i < 3000; ++i) {
      const Vec3f at{uniform(), uniform(), uniform()};
      const float size = i % 10 == 0 ? 0.9f : 0.01f;
      vertices.push_back(at);
      vertices.push_back({at.x + size, at.y + size * 0.9f, at.z + size * uniform()});
      vertices.push_back({at.x + size * 0.98f, at.y + size, at.z + size * uniform()});
      triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
  }
  TriangleMesh mesh() const { return {.vertices = vertices, .triangles = triangles}; }
};

Box box_of_child(const PairNode& node, int child) {
  return child_box(node, child);
}
bool contains(const Box& outer, const Box& inner) {
  bool in = true;
  for (int axis = 0; axis < 3; ++axis)
    in &= outer.lower[axis] <= inner.lower[axis] && outer.upper[axis] >= inner.upper[axis];
  return in;
}

// Every node's box holds those below, every reference is in one leaf; returns the longest path.
std::uint32_t check_tree(const HostHierarchy& hierarchy) {
  std::vector<std::uint32_t> seen(hierarchy.triangles.size());
  const auto visit = [&](auto&& self, std::uint32_t number, std::uint32_t parent) -> std::uint32_t {
    const PairNode& node = hierarchy.nodes[number];
    EXPECT_EQ(node.parent, parent);
    EXPECT_EQ(node.arrived, 0u);
    std::uint32_t depth = 0;
    for (int child = 0; child < 2; ++child) {
      const std::uint32_t link = node.link[child];
      if ((link & leaf_bit) != 0) {
        for (std::uint32_t i = leaf_first(link); i < leaf_first(link) + leaf_count(link); ++i) ++seen[i];
        continue;
      }
      EXPECT_GT(link, number);
      for (int grandchild = 0; grandchild < 2; ++grandchild)
        EXPECT_TRUE(contains(box_of_child(node, child), box_of_child(hierarchy.nodes[link], grandchild)));
      depth = std::max(depth, self(self, link, number));
    }
    return depth + 1;
  };
  const std::uint32_t depth = visit(visit, 0, no_link);
  for (const std::uint32_t times : seen)
    EXPECT_EQ(times, hierarchy.nodes.size() == 1 && hierarchy.nodes[0].link[0] == hierarchy.nodes[0].link[1]
                         ? 2u
                         : 1u);
  return depth;
}

TEST(CudaBuild, TreesAreWhole) {
  const Slats slats;
  const TriangleMesh mesh = slats.mesh();
  for (const float ratio : {1.0f, 1.5f, 3.0f}) {
    BuiltHierarchy<HostExecutor> figures;
    const HostHierarchy hierarchy = built({&mesh, 1}, {.max_reference_ratio = ratio}, &figures);
    EXPECT_LE(hierarchy.triangles.size(), static_cast<std::size_t>(ratio * 3000));
    EXPECT_LT(check_tree(hierarchy), max_depth);
    if (ratio > 1.0f) {
      EXPECT_GT(static_cast<double>(hierarchy.triangles.size()), 0.9 * ratio * 3000);
    }
  }
}

TEST(CudaBuild, SplitsMakeLeavesSmaller) {
  const Slats slats;
  const TriangleMesh mesh = slats.mesh();
  BuiltHierarchy<HostExecutor> whole, split;
  built({&mesh, 1}, {.max_reference_ratio = 1.0f}, &whole);
  built({&mesh, 1}, {.max_reference_ratio = 2.0f}, &split);
  EXPECT_LT(split.cost, 0.8f * whole.cost);
}

TEST(CudaBuild, PartsOfASplitTriangleCoverIt) {
  std::mt19937 random(11);
  const auto uniform = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
  for (int i = 0; i < 2000; ++i) {
    const auto corner = [&] { return Vec3f{uniform(), uniform(), uniform()}; };
    const Corners t{corner(), corner(), corner()};
    const Box whole = box_of(t);
    const Grid grid = grid_over(Box{{0, 0, 0}, {1, 1, 1}});
    Reference parts[64];
    const std::uint32_t count = split_triangle(t, whole, 7, 63, grid, parts);
    EXPECT_LE(count, 64u);
    for (std::uint32_t k = 0; k < count; ++k) EXPECT_TRUE(contains(whole, parts[k].box));
    for (int sample = 0; sample < 100; ++sample) {
      double u = uniform(), v = uniform();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      double p[3];
      for (int axis = 0; axis < 3; ++axis)
        p[axis] = (1 - u - v) * component(t.a, axis) + u * component(t.b, axis) + v * component(t.c, axis);
      bool covered = false;
      for (std::uint32_t k = 0; k < count; ++k) {
        bool in = true;
        for (int axis = 0; axis < 3; ++axis)
          in &= parts[k].box.lower[axis] <= p[axis] && p[axis] <= parts[k].box.upper[axis];
        covered |= in;
      }
      EXPECT_TRUE(covered);
    }
  }
}

TEST(CudaBuild, EqualBoxesMakeAShallowTree) {
  const std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<std::array<std::uint32_t, 3>> triangles(5000, {0, 1, 2});
  const TriangleMesh mesh{.vertices = vertices, .triangles = triangles};
  EXPECT_LT(check_tree(built({&mesh, 1}, {})), 40u);
}

TEST(CudaBuild, RoundsWithoutChoiceEndSoon) {
  std::vector<std::uint32_t> clusters(1000), neighbour(1000);
  std::vector<MergedNode> nodes(1000);
  for (std::uint32_t i = 0; i < 1000; ++i) clusters[i] = i;
  for (std::uint32_t count : {2u, 3u, 999u, 1000u}) {
    for (std::uint32_t i = 0; i < count; ++i)
      FindNeighbour{nodes.data(), clusters.data(), count, 0, 1.0f, neighbour.data()}(i);
    for (std::uint32_t i = 0; i + 1 < count; i += 2) EXPECT_EQ(neighbour[i], i + 1);
  }
}

TEST(CudaBuild, SortsKeepTheOrderOfEqualKeys) {
  constexpr std::uint32_t count = 1000, keys = 7;
  std::vector<std::uint32_t> items(count);
  std::iota(items.begin(), items.end(), 0u);
  sort_by_key(items, [](std::uint32_t item) { return double(item % keys); });
  std::vector<std::uint32_t> expected;
  for (std::uint32_t key = 0; key < keys; ++key) {
    for (std::uint32_t item = key; item < count; item += keys) expected.push_back(item);
  }
  EXPECT_EQ(items, expected);
}

TEST(CudaBuild, SaysWhatIsWrongWithAMesh) {
  std::vector<Vec3f> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 3}};
  const auto problems = [&] {
    const TriangleMesh mesh{.vertices = vertices, .triangles = triangles};
    BuiltHierarchy<HostExecutor> figures;
    built({&mesh, 1}, {}, &figures);
    return figures.problems;
  };
  EXPECT_EQ(problems(), index_out_of_range);
  triangles[0][2] = 2;
  EXPECT_EQ(problems(), 0u);
  vertices[1].y = std::numeric_limits<float>::infinity();
  EXPECT_EQ(problems(), vertex_not_finite);
  vertices[1].y = 0x1p126f;
  EXPECT_EQ(problems(), vertex_not_finite);
}

void refit(HostHierarchy& hierarchy, std::span<const TriangleMesh> meshes) {
  std::vector<std::uint32_t> firsts;
  const std::vector<InputMesh> input = input_of(meshes, firsts);
  std::uint32_t problems = 0;
  MoveReference move{};
  move.mesh_count = static_cast<std::uint32_t>(input.size());
  std::copy(input.begin(), input.end(), move.meshes);
  move.end = firsts.back();
  move.numbers = hierarchy.numbers.data();
  move.triangles = hierarchy.triangles.data();
  move.problems = &problems;
  for (std::uint32_t i = 0; i < hierarchy.triangles.size(); ++i) move(i);
  const RefitNode node{hierarchy.nodes.data(), hierarchy.triangles.data(), &hierarchy.bounds};
  for (std::uint32_t i = 0; i < hierarchy.nodes.size(); ++i) node(i);
}

TEST(CudaRefit, AnswersAreThoseOfANewBuild) {
  ClosedSurface surface;
  const TriangleMesh mesh = surface.mesh();
  const Tree tree = build_tree(mesh);
  std::vector<HostHierarchy> hierarchies;
  hierarchies.push_back(uploaded(source_of(tree), first_triangles_of(tree)));
  hierarchies.push_back(built({&mesh, 1}, {}));
  hierarchies.push_back(built({&mesh, 1}, {.max_reference_ratio = 1.0f}));
  std::mt19937 random(9);
  const auto uniform = [&] { return 3.0f * static_cast<float>(random() >> 8) * 0x1p-24f - 1.5f; };
  for (int frame = 0; frame < 3; ++frame) {
    for (Vec3f& v : surface.vertices) {
      v.x += 0.3f * v.z * v.z;
      v.y *= 1.1f;
    }
    // Triangles may lose their area, and have one again.
    const Vec3f kept = surface.vertices[30];
    if (frame == 1) surface.vertices[30] = surface.vertices[31];
    const kerf::Bvh bvh = kerf::build(surface.mesh());
    for (HostHierarchy& hierarchy : hierarchies) {
      const TriangleMesh moved = surface.mesh();
      refit(hierarchy, {&moved, 1});
      check_tree(hierarchy);
      const Box3f bounds = bvh.bounds();
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(hierarchy.bounds.lower[axis], bounds.lower[axis]);
        EXPECT_EQ(hierarchy.bounds.upper[axis], bounds.upper[axis]);
      }
      std::size_t different = 0;
      for (int i = 0; i < 1000; ++i) {
        const Vec3f p{uniform(), uniform(), uniform()};
        Ray ray{.origin = p, .direction = {uniform(), uniform(), uniform()}};
        different += !(hierarchy.intersect(ray) == bvh.intersect(ray).value_or(Hit{}));
        std::vector<Hit> all;
        bvh.all_hits(ray, [&](const Hit& hit) { all.push_back(hit); });
        different += hierarchy.all_hits(ray) != all;
        different += hierarchy.contains(p) != bvh.contains(p);
        different +=
            !(hierarchy.closest_point(p, 10.0f) == bvh.closest_point(p, 10.0f).value_or(SurfacePoint{}));
      }
      EXPECT_EQ(different, 0u) << frame;
    }
    surface.vertices[30] = kept;
  }
}

}  // namespace
}  // namespace kerf::cuda
