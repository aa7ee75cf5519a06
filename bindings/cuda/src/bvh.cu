#include <string>
#include <utility>
#include <vector>

#include <kerf/cuda/bvh.hpp>

#include "build/build.hpp"
#include "content.hpp"
#include "device_executor.cuh"
#include "encode.hpp"
#include "launch.hpp"
#include "refit.hpp"
#include "source_tree.hpp"

namespace kerf::cuda {
namespace {

constexpr std::size_t max_references = std::size_t{1} << 28;  // as links can count

SceneBounds bounds_of(const Box& box) {
  SceneBounds bounds;
  for (int axis = 0; axis < 3; ++axis) {
    bounds.lower[axis] = box.lower[axis];
    bounds.upper[axis] = box.upper[axis];
  }
  return bounds;
}

void count_bytes(Bvh::Content& content) {
  content.statistics.references = content.triangles.size();
  content.statistics.nodes = content.nodes.size();
  content.statistics.bytes = content.nodes.size() * sizeof(PairNode) +
                             content.triangles.size() * sizeof(DeviceTriangle) +
                             content.numbers.size() * sizeof(std::uint32_t) +
                             content.first_triangles.size() * sizeof(std::uint32_t) + sizeof(SceneBounds);
}

std::shared_ptr<Bvh::Content> upload(const SourceTree& tree, std::vector<std::uint32_t> first_triangles) {
  auto content = std::make_shared<Bvh::Content>();
  const EncodedBinary encoded = encode_binary(tree);
  std::vector<std::uint32_t> numbers;
  numbers.reserve(tree.references.size());
  for (const SourceTriangle& reference : tree.references) numbers.push_back(reference.number);
  content->nodes = DeviceArray<PairNode>(std::span(encoded.nodes));
  content->triangles = DeviceArray<DeviceTriangle>(std::span(encoded.triangles));
  content->numbers = DeviceArray<std::uint32_t>(std::span<const std::uint32_t>(numbers));
  content->bounds = DeviceArray<SceneBounds>(std::span<const SceneBounds>(&encoded.bounds, 1));
  content->first_triangles = DeviceArray<std::uint32_t>(std::span<const std::uint32_t>(first_triangles));
  content->problems = DeviceArray<std::uint32_t>(1);
  content->statistics.triangles = first_triangles.empty() ? 0 : first_triangles.back();
  content->mesh_firsts = std::move(first_triangles);
  count_bytes(*content);
  check(cudaStreamSynchronize(nullptr), "copying a hierarchy to the device");
  return content;
}

// Checks sizes, and says where each mesh's triangles begin.
std::vector<InputMesh> input_meshes(std::span<const TriangleMesh> meshes,
                                    std::vector<std::uint32_t>& firsts) {
  std::vector<InputMesh> result;
  std::size_t count = 0;
  for (const TriangleMesh& mesh : meshes) {
    firsts.push_back(static_cast<std::uint32_t>(count));
    if (mesh.vertices.size() > 0xffffffffu || mesh.triangles.size() > max_references)
      throw Error("reading meshes", "a mesh is too large");
    result.push_back({mesh.vertices.data(), mesh.vertices.stride(),
                      static_cast<std::uint32_t>(mesh.vertices.size()), mesh.triangles.data(),
                      mesh.triangles.stride(), static_cast<std::uint32_t>(mesh.triangles.size()),
                      firsts.back()});
    count += mesh.triangles.size();
    if (count > max_references) throw Error("reading meshes", "more than 2^28 triangles");
  }
  firsts.push_back(static_cast<std::uint32_t>(count));
  return result;
}

// Without meshes at the end that have no triangles.
std::vector<std::uint32_t> trimmed(std::vector<std::uint32_t> firsts) {
  while (firsts.size() > 1 && firsts[firsts.size() - 2] == firsts.back()) firsts.pop_back();
  return firsts;
}

void check_options(const BuildOptions& options) {
  if (!(options.max_reference_ratio >= 1.0f && options.max_reference_ratio <= 16.0f))
    throw Error("building", "max_reference_ratio must be in [1, 16]");
  if (options.max_leaf_size < 1 || options.max_leaf_size > 8)
    throw Error("building", "max_leaf_size must be in [1, 8]");
  if (options.radius < 1 || options.radius > 64) throw Error("building", "radius must be in [1, 64]");
}

std::size_t reference_bound(std::size_t triangles, const BuildOptions& options) {
  return static_cast<std::size_t>(static_cast<double>(options.max_reference_ratio) *
                                  static_cast<double>(triangles));
}

}  // namespace

Bvh::Bvh(const kerf::Bvh& bvh) {
  const Layout arrays = layout(bvh);
  content_ = upload(source_of(arrays), {arrays.first_triangles.begin(), arrays.first_triangles.end()});
}

Bvh::Bvh(const kerf::Tree& tree) : content_(upload(source_of(tree), first_triangles_of(tree))) {}

Bvh Bvh::build(std::span<const TriangleMesh> meshes, const BuildOptions& options, Stream stream) {
  check_options(options);
  auto content = std::make_shared<Content>();
  const std::vector<InputMesh> input = input_meshes(meshes, content->mesh_firsts);
  const std::uint32_t count = content->mesh_firsts.back();
  const std::size_t references = reference_bound(count, options);
  if (references > max_references) throw Error("building", "more than 2^28 references are allowed for");
  DeviceExecutor executor(scratch_bytes(count, options.max_reference_ratio, DeviceExecutor::alignment),
                          static_cast<std::uint32_t>(references), stream);
  BuiltHierarchy<DeviceExecutor> built =
      build_hierarchy(executor, std::span(input), count,
                      {options.max_reference_ratio, options.max_leaf_size, options.radius});
  if ((built.problems & index_out_of_range) != 0)
    throw Error("building", "a triangle names a vertex that its mesh has not");
  if ((built.problems & vertex_not_finite) != 0)
    throw Error("building", "a vertex is not finite, or not below 2^126");
  const SceneBounds bounds = bounds_of(built.bounds);
  content->nodes = std::move(built.nodes);
  content->triangles = std::move(built.triangles);
  content->numbers = std::move(built.numbers);
  content->bounds = DeviceArray<SceneBounds>(std::span<const SceneBounds>(&bounds, 1));
  content->first_triangles = DeviceArray<std::uint32_t>(std::span<const std::uint32_t>(content->mesh_firsts));
  content->problems = DeviceArray<std::uint32_t>(1);
  content->statistics.triangles = count;
  content->statistics.degenerate_triangles = built.degenerate;
  content->statistics.scratch_bytes = executor.bytes();
  content->statistics.cost = static_cast<double>(built.cost);
  count_bytes(*content);
  check(cudaStreamSynchronize(stream), "building");
  check(cudaStreamSynchronize(nullptr), "building");
  return Bvh(std::move(content));
}

void Bvh::intersect(const Ray* rays, Hit* hits, std::size_t count, Stream stream) const {
  launch_closest(view(content_), table(content_), rays, hits, count, stream);
}
void Bvh::occluded(const Ray* rays, std::uint8_t* occluded, std::size_t count, Stream stream) const {
  launch_any(view(content_), rays, occluded, count, stream);
}
void Bvh::count_hits(const Ray* rays, std::uint32_t* counts, std::size_t count, Stream stream) const {
  launch_count_hits(view(content_), rays, counts, count, stream);
}
void Bvh::list_hits(const Ray* rays, const std::uint64_t* offsets, Hit* hits, std::size_t count,
                    Stream stream) const {
  launch_list_hits(view(content_), table(content_), rays, offsets, hits, count, stream);
}
void Bvh::contains(const Vec3f* points, std::uint8_t* inside, std::size_t count, Stream stream) const {
  launch_contains(view(content_), points, inside, count, stream);
}
void Bvh::closest_point(const Vec3f* points, SurfacePoint* closest, std::size_t count, float max_distance,
                        Stream stream) const {
  launch_closest_point(view(content_), table(content_), points, closest, count, max_distance, stream);
}
void Bvh::signed_distance(const Vec3f* points, float* distances, std::size_t count, Stream stream) const {
  launch_signed_distance(view(content_), table(content_), points, distances, count, stream);
}

void Bvh::refit(std::span<const TriangleMesh> meshes, Stream stream) {
  std::vector<std::uint32_t> firsts;
  const std::vector<InputMesh> input = input_meshes(meshes, firsts);
  const std::vector<std::uint32_t> none{0};
  if (trimmed(firsts) != trimmed(content_ ? content_->mesh_firsts : none))
    throw Error("refitting", "the meshes are not those of the build");
  if (!content_ || content_->nodes.size() == 0) return;
  const auto run = [&](std::size_t count, const auto& work) {
    run_for_each<<<static_cast<unsigned>((count + 127) / 128), 128, 0, stream>>>(
        static_cast<std::uint32_t>(count), work);
    check(cudaGetLastError(), "starting to refit");
  };
  for (std::size_t first = 0; first < input.size(); first += MoveReference::max_meshes) {
    MoveReference move{};
    move.mesh_count =
        static_cast<std::uint32_t>(std::min<std::size_t>(input.size() - first, MoveReference::max_meshes));
    std::copy_n(input.begin() + static_cast<std::ptrdiff_t>(first), move.mesh_count, move.meshes);
    move.end = firsts[first + move.mesh_count];
    move.numbers = content_->numbers.data();
    move.triangles = content_->triangles.data();
    move.problems = content_->problems.data();
    run(content_->triangles.size(), move);
  }
  run(content_->nodes.size(),
      RefitNode{content_->nodes.data(), content_->triangles.data(), content_->bounds.data()});
}

Box3f Bvh::bounds() const {
  Box3f box;
  if (!content_ || content_->nodes.size() == 0) return box;
  // A stream that does not wait for the default one may still refit.
  check(cudaDeviceSynchronize(), "waiting for the device");
  SceneBounds bounds;
  content_->bounds.copy_to({&bounds, 1});
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = bounds.lower[axis];
    box.upper[axis] = bounds.upper[axis];
  }
  return box;
}

const BvhStatistics& Bvh::statistics() const {
  static const BvhStatistics nothing;
  return content_ ? content_->statistics : nothing;
}

std::size_t build_bytes(std::size_t triangles, const BuildOptions& options) {
  check_options(options);
  const std::size_t references = reference_bound(triangles, options);
  // What sorting and summing take besides is under a hundredth of what they work on.
  return scratch_bytes(triangles, options.max_reference_ratio, DeviceExecutor::alignment) + 12 * references +
         references / 4 + (std::size_t{8} << 20) +
         references * (sizeof(PairNode) + sizeof(DeviceTriangle) + sizeof(std::uint32_t));
}

}  // namespace kerf::cuda
