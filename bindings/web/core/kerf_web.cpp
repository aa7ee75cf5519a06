// What JavaScript calls: plain functions over <kerf/kerf.hpp>, whose arguments are numbers and addresses in
// the memory of the module. One thread runs at a time, so that answers of unknown length wait in one place.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <new>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

#define KERF_EXPORT(name) extern "C" __attribute__((used, export_name(#name)))

// JavaScript's answer to how far a build has come: 0 cancels it.
extern "C" __attribute__((import_module("kerf"), import_name("progress"))) int kerf_progress(float fraction);

namespace {

using kerf::Bvh;

// What a call returns: 0, or 1 + `Error::code`, and behind these what is no `Error`.
constexpr int internal_error = 100;

char sentence[512] = "";  // of the last error

// An answer of unknown length, in words of 32 bits; `offsets` has one entry more than there were questions.
std::vector<std::uint32_t> items, offsets;
std::vector<std::byte> file;  // of the last save
// The answers of one length.
kerf::Hit hit;
kerf::SurfacePoint surface_point;
std::array<double, 16> numbers;

int fail(int code, const char* why) {
  std::strncpy(sentence, why, sizeof sentence - 1);
  return code;
}

// Calls `work` and says how it ended.
template <class Work>
int guarded(const Work& work) {
  try {
    work();
    return 0;
  } catch (const kerf::Error& error) {
    return fail(1 + error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(1 + kerf::Error::out_of_memory, "not enough memory");
  } catch (const std::exception& error) {
    return fail(internal_error, error.what());
  }
}

template <class Item>
void answer(std::span<const Item> list) {
  static_assert(sizeof(Item) % sizeof(std::uint32_t) == 0);
  items.resize(list.size() * (sizeof(Item) / sizeof(std::uint32_t)));
  if (!list.empty()) std::memcpy(items.data(), list.data(), list.size_bytes());
}
template <class Item>
void answer(const kerf::Lists<Item>& lists) {
  offsets.assign(lists.offsets.begin(), lists.offsets.end());
  answer(std::span<const Item>(lists.items));
}

struct MeshView {
  const float* positions;
  std::uint32_t vertex_count;
  std::uint32_t stride;            // bytes from one vertex to the next
  const std::uint32_t* triangles;  // null: vertices 0, 1, 2; 3, 4, 5; ...
  std::uint32_t triangle_count;
};

struct OptionsView {
  std::int32_t builder;
  float alpha;
  float max_reference_ratio;
  std::uint32_t max_leaf_size;
  std::uint32_t skip_non_finite;
  std::uint32_t presplit_references;
  std::uint32_t progress;  // whether JavaScript wants to hear of it
  std::int32_t quality;
};

// Calls `work` with a mesh as the library takes it.
template <class Work>
void with_mesh(const MeshView& view, const Work& work) {
  std::vector<std::uint32_t> counted;
  const std::uint32_t* triangles = view.triangles;
  if (triangles == nullptr) {
    counted.resize(std::size_t{3} * view.triangle_count);
    for (std::size_t i = 0; i < counted.size(); ++i) counted[i] = static_cast<std::uint32_t>(i);
    triangles = counted.data();
  }
  work(kerf::TriangleMesh{.vertices = kerf::TripleView<float>(view.positions, view.vertex_count, view.stride),
                          .triangles = kerf::TripleView<std::uint32_t>(triangles, view.triangle_count)});
}

kerf::BuildOptions to_options(const OptionsView& view) {
  if (view.builder < 0 || view.builder >= static_cast<int>(kerf::builders().size()))
    throw kerf::Error(kerf::Error::invalid_argument, "there is no such builder");
  kerf::BuildOptions options;
  options.builder = static_cast<kerf::Builder>(view.builder);
  options.quality = static_cast<kerf::Quality>(view.quality);
  options.alpha = view.alpha;
  options.max_reference_ratio = view.max_reference_ratio;
  options.max_leaf_size = view.max_leaf_size;
  options.non_finite = view.skip_non_finite != 0 ? kerf::NonFinite::skip : kerf::NonFinite::refuse;
  options.presplit_references = view.presplit_references;
  if (view.progress != 0) options.progress = [](float fraction) { return kerf_progress(fraction) != 0; };
  return options;
}

// A part of a mesh that rays see, and from which side: how three.js describes groups and materials.
struct Part {
  std::uint32_t first, last;  // triangles first ... last - 1
  std::uint32_t side;         // 0: the front, 1: the back, 2: both
};

class Parts {
 public:
  Parts(const Bvh& bvh, const Part* parts, std::uint32_t count) : bvh_(bvh), parts_(parts, count) {}

  bool see(const kerf::Ray& ray, const kerf::Hit& hit) const {
    std::optional<bool> front;
    return std::any_of(parts_.begin(), parts_.end(), [&](const Part& part) {
      if (hit.primitive < part.first || hit.primitive >= part.last) return false;
      if (part.side == 2) return true;
      if (!front) front = bvh_.geometry(ray, hit).front;
      return *front == (part.side == 0);
    });
  }

 private:
  const Bvh& bvh_;
  std::span<const Part> parts_;
};

kerf::Ray ray_of(float ox, float oy, float oz, float dx, float dy, float dz, float t_min, float t_max) {
  return {.origin = {ox, oy, oz}, .direction = {dx, dy, dz}, .t_min = t_min, .t_max = t_max};
}

// Many rays in the module's memory. Strides are bytes; a null limit stands for that of all rays.
struct RaysView {
  const float* origins;
  const float* directions;
  std::uint32_t count;
  std::int32_t origin_stride, direction_stride;
  const float* t_min;
  const float* t_max;
  std::int32_t t_min_stride, t_max_stride;

  kerf::RayView view() const {
    kerf::RayView rays =
        kerf::RayView::origins_and_directions(origins, directions, count, origin_stride, direction_stride);
    if (t_min != nullptr) rays.t_min = {t_min, t_min_stride};
    if (t_max != nullptr) rays.t_max = {t_max, t_max_stride};
    return rays;
  }
  kerf::Ray operator[](std::size_t i) const {
    const auto row = [i](const float* first, std::int32_t stride) {
      return reinterpret_cast<const float*>(reinterpret_cast<const std::byte*>(first) +
                                            static_cast<std::ptrdiff_t>(i) * stride);
    };
    const float *o = row(origins, origin_stride), *d = row(directions, direction_stride);
    kerf::Ray ray{.origin = {o[0], o[1], o[2]}, .direction = {d[0], d[1], d[2]}};
    if (t_min != nullptr) ray.t_min = *row(t_min, t_min_stride);
    if (t_max != nullptr) ray.t_max = *row(t_max, t_max_stride);
    return ray;
  }
};

kerf::PointView points_of(const float* points, std::uint32_t count) {
  return kerf::TripleView<float>(points, count);
}

// A binary tree in the nodes of three-mesh-bvh, depth first: a node is followed by its left child, which lies
// lower along the node's axis, and holds how many nodes after it the right one comes. The triangles of a
// subtree stand side by side.
class PackedTree {
 public:
  explicit PackedTree(const kerf::Tree& tree) : nodes_(tree.nodes()), references_(tree.references()) {
    words_.reserve(std::max<std::size_t>(nodes_.size(), 1) * words_per_node);
    triangles_.reserve(references_.size());
    if (nodes_.empty()) {
      write({}, leaf_mark, 0);
      return;
    }
    std::vector<std::pair<std::uint32_t, std::size_t>>
        waiting;  // right children, and where their parents stand
    std::uint32_t node = 0;
    while (true) {
      if (!nodes_[node].is_leaf()) {
        const auto [axis, swapped] = order_of(nodes_[node]);
        waiting.emplace_back(swapped ? nodes_[node].left() : nodes_[node].right(), words_.size());
        write(nodes_[node].bounds, axis, 0);
        node = swapped ? nodes_[node].right() : nodes_[node].left();
        continue;
      }
      write_leaf(nodes_[node]);
      if (waiting.empty()) return;
      const auto [right, parent] = waiting.back();
      waiting.pop_back();
      words_[parent + 6] = static_cast<std::uint32_t>((words_.size() - parent) / words_per_node);
      node = right;
    }
  }

  std::vector<std::uint32_t> take_words() { return std::move(words_); }
  std::vector<std::uint32_t> take_triangles() { return std::move(triangles_); }

 private:
  static constexpr std::size_t words_per_node = 8;
  static constexpr std::uint32_t leaf_mark = 0xffff0000u;

  void write(const kerf::Box3f& bounds, std::uint32_t axis_or_count, std::uint32_t place) {
    for (const kerf::Vec3f& corner : {bounds.lower, bounds.upper}) {
      for (int axis = 0; axis < 3; ++axis) words_.push_back(std::bit_cast<std::uint32_t>(corner[axis]));
    }
    words_.push_back(place);
    words_.push_back(axis_or_count);
  }
  void write_leaf(const kerf::BinaryNode& leaf) {
    write(leaf.bounds, leaf_mark | leaf.count, static_cast<std::uint32_t>(triangles_.size()));
    const auto own = references_.subspan(leaf.first, leaf.count);
    triangles_.insert(triangles_.end(), own.begin(), own.end());
  }

  // The axis along which the middles of the children lie farthest apart, and whether the right one lies
  // lower.
  std::pair<std::uint32_t, bool> order_of(const kerf::BinaryNode& node) const {
    const kerf::Box3f &left = nodes_[node.left()].bounds, &right = nodes_[node.right()].bounds;
    std::uint32_t best = 0;
    float widest = 0;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis);
      const float apart = 0.5f * (right.lower[a] - left.lower[a]) + 0.5f * (right.upper[a] - left.upper[a]);
      if (std::abs(apart) <= std::abs(widest)) continue;
      best = axis;
      widest = apart;
    }
    return {best, widest < 0};
  }

  std::span<const kerf::BinaryNode> nodes_;
  std::span<const std::uint32_t> references_;
  std::vector<std::uint32_t> words_, triangles_;
};

}  // namespace

// ---- Memory, errors and answers ----

KERF_EXPORT(allocate) void* allocate(std::uint32_t bytes) {
  return std::aligned_alloc(64, (bytes + 63u) & ~63u);
}
KERF_EXPORT(release) void release(void* memory) {
  std::free(memory);
}
KERF_EXPORT(error) const char* error() {
  return sentence;
}
KERF_EXPORT(items) const std::uint32_t* get_items() {
  return items.data();
}
KERF_EXPORT(item_words) std::uint32_t item_words() {
  return static_cast<std::uint32_t>(items.size());
}
KERF_EXPORT(offsets) const std::uint32_t* get_offsets() {
  return offsets.data();
}
KERF_EXPORT(hit) const kerf::Hit* get_hit() {
  return &hit;
}
KERF_EXPORT(surface_point) const kerf::SurfacePoint* get_surface_point() {
  return &surface_point;
}
KERF_EXPORT(numbers) const double* get_numbers() {
  return numbers.data();
}
KERF_EXPORT(forget) void forget() {
  items = {};
  offsets = {};
  file = {};
}

// ---- Builds and files ----

KERF_EXPORT(build) int build(const MeshView* mesh, const OptionsView* options, Bvh** made) {
  return guarded([&] {
    with_mesh(*mesh, [&](const kerf::TriangleMesh& triangles) {
      *made = new Bvh(kerf::build(triangles, to_options(*options)));
    });
  });
}

// The items are nodes, the offsets the triangles of leaves; the numbers are the surface area cost and counts.
KERF_EXPORT(pack) int pack(const MeshView* mesh, const OptionsView* options) {
  return guarded([&] {
    with_mesh(*mesh, [&](const kerf::TriangleMesh& triangles) {
      const kerf::Tree tree = kerf::build_tree(triangles, to_options(*options));
      PackedTree packed(tree);
      items = packed.take_words();
      offsets = packed.take_triangles();
      numbers = {kerf::surface_area_cost(tree), static_cast<double>(tree.nodes().size()),
                 static_cast<double>(tree.references().size())};
    });
  });
}

KERF_EXPORT(destroy) void destroy(const Bvh* bvh) {
  delete bvh;
}

// The file is as long as `file_bytes` says and begins where `file` says, until `forget`.
KERF_EXPORT(save) int save(const Bvh* bvh) {
  return guarded([&] { file = bvh->save(); });
}
KERF_EXPORT(file) const std::byte* get_file() {
  return file.data();
}
KERF_EXPORT(file_bytes) std::uint32_t file_bytes() {
  return static_cast<std::uint32_t>(file.size());
}
KERF_EXPORT(load) int load(const std::byte* bytes, std::uint32_t count, Bvh** made) {
  return guarded([&] { *made = new Bvh(Bvh::load(std::span(bytes, count))); });
}

KERF_EXPORT(statistics) void statistics(const Bvh* bvh) {
  const kerf::BvhStatistics& of = bvh->statistics();
  const kerf::Box3f box = bvh->bounds();
  const auto number = [](std::size_t count) { return static_cast<double>(count); };
  numbers = {number(of.triangles),
             number(of.degenerate_triangles),
             number(of.non_finite_triangles),
             number(of.references),
             number(of.nodes),
             number(of.bytes),
             number(of.build_peak_bytes),
             of.build_seconds,
             double{box.lower.x},
             double{box.lower.y},
             double{box.lower.z},
             double{box.upper.x},
             double{box.upper.y},
             double{box.upper.z},
             number(kerf::layout(*bvh).width),
             number(kerf::layout(*bvh).depth)};
}

// The boxes that are `level` nodes below the root, and leaves above them: six floats each.
KERF_EXPORT(boxes) int boxes(const Bvh* bvh, std::uint32_t level) {
  return guarded([&] {
    const kerf::Layout layout = kerf::layout(*bvh);
    std::vector<kerf::Box3f> found;
    if (layout.node_count != 0 && level == 0) found.push_back(layout.bounds);
    std::vector<std::uint32_t> nodes, next;
    if (layout.node_count != 0) nodes.push_back(0);
    for (std::uint32_t depth = 1; depth <= level; ++depth, nodes.swap(next), next.clear()) {
      for (const std::uint32_t node : nodes) {
        for (std::uint32_t slot = 0; slot < layout.width; ++slot) {
          const kerf::Box3f box = layout.box(node, slot);
          if (box.empty()) continue;
          const kerf::ChildLink child = layout.child(node, slot);
          if (!child.is_leaf()) next.push_back(child.node());
          if (child.is_leaf() || depth == level) found.push_back(box);
        }
      }
    }
    answer(std::span<const kerf::Box3f>(found));
  });
}

// ---- Rays ----

// 1 for a hit, 0 for none, -1 if something went wrong. Without parts, all triangles are seen from both sides.
KERF_EXPORT(intersect)
int intersect(const Bvh* bvh, float ox, float oy, float oz, float dx, float dy, float dz, float t_min,
              float t_max, const Part* parts, std::uint32_t part_count) {
  const kerf::Ray ray = ray_of(ox, oy, oz, dx, dy, dz, t_min, t_max);
  if (part_count == 0) return bvh->intersect(ray, hit) ? 1 : 0;
  bool found = false;
  const int status = guarded([&] {
    const Parts seen(*bvh, parts, part_count);
    // The closest of all hits is mostly seen, and then it is the closest of those that are.
    found = bvh->intersect(ray, hit);
    if (!found || seen.see(ray, hit)) return;
    const auto other = bvh->intersect(ray, [&](const kerf::Hit& at) { return seen.see(ray, at); });
    found = other.has_value();
    hit = other.value_or(kerf::Hit());
  });
  return status != 0 ? -status : found ? 1 : 0;
}

KERF_EXPORT(occluded)
int occluded(const Bvh* bvh, float ox, float oy, float oz, float dx, float dy, float dz, float t_min,
             float t_max, const Part* parts, std::uint32_t part_count) {
  const kerf::Ray ray = ray_of(ox, oy, oz, dx, dy, dz, t_min, t_max);
  if (part_count == 0) return bvh->occluded(ray) ? 1 : 0;
  bool found = false;
  const int status = guarded([&] {
    const Parts seen(*bvh, parts, part_count);
    found = bvh->occluded(ray, [&](const kerf::Hit& at) { return seen.see(ray, at); });
  });
  return status != 0 ? -status : found ? 1 : 0;
}

// The items are hits.
KERF_EXPORT(all_hits)
int all_hits(const Bvh* bvh, float ox, float oy, float oz, float dx, float dy, float dz, float t_min,
             float t_max) {
  return guarded([&] {
    std::vector<kerf::Hit> hits;
    bvh->all_hits(ray_of(ox, oy, oz, dx, dy, dz, t_min, t_max),
                  [&](const kerf::Hit& at) { hits.push_back(at); });
    answer(std::span<const kerf::Hit>(hits));
  });
}

// Whether the ray of a hit comes from the front of its triangle: 1 or 0, or minus what went wrong.
KERF_EXPORT(is_front)
int is_front(const Bvh* bvh, float ox, float oy, float oz, float dx, float dy, float dz,
             std::uint32_t primitive) {
  bool front = false;
  const int status = guarded([&] {
    kerf::Hit at;
    at.primitive = primitive;
    at.mesh = 0;
    front = bvh->geometry(ray_of(ox, oy, oz, dx, dy, dz, 0, 0), at).front;
  });
  return status != 0 ? -status : front ? 1 : 0;
}

KERF_EXPORT(intersect_many)
int intersect_many(const Bvh* bvh, const RaysView* rays, float* t, float* u, float* v,
                   std::uint32_t* primitive, const Part* parts, std::uint32_t part_count) {
  return guarded([&] {
    kerf::HitView hits;
    hits.count = rays->count;
    hits.t.data = t;
    hits.u.data = u;
    hits.v.data = v;
    hits.primitive.data = primitive;
    if (part_count == 0) return bvh->intersect(rays->view(), hits);
    const Parts seen(*bvh, parts, part_count);
    bvh->intersect(rays->view(), hits,
                   [&](std::size_t i, const kerf::Hit& at) { return seen.see((*rays)[i], at); });
  });
}

KERF_EXPORT(occluded_many)
int occluded_many(const Bvh* bvh, const RaysView* rays, std::uint8_t* flags, const Part* parts,
                  std::uint32_t part_count) {
  return guarded([&] {
    const kerf::FlagView answers(flags, rays->count);
    if (part_count == 0) return bvh->occluded(rays->view(), answers);
    const Parts seen(*bvh, parts, part_count);
    bvh->occluded(rays->view(), answers,
                  [&](std::size_t i, const kerf::Hit& at) { return seen.see((*rays)[i], at); });
  });
}

KERF_EXPORT(count_hits_many)
int count_hits_many(const Bvh* bvh, const RaysView* rays, std::uint32_t* counts) {
  return guarded([&] { bvh->count_hits(rays->view(), std::span(counts, rays->count)); });
}
// The items are hits.
KERF_EXPORT(all_hits_many) int all_hits_many(const Bvh* bvh, const RaysView* rays) {
  return guarded([&] { answer(bvh->all_hits(rays->view())); });
}

// What closest-hit rays cost: inner nodes visited plus triangles tested, of each.
KERF_EXPORT(count_steps)
int count_steps(const Bvh* bvh, const RaysView* rays, std::uint32_t* steps, std::uint32_t* triangle_tests) {
  return guarded([&] {
    for (std::uint32_t i = 0; i < rays->count; ++i) {
      kerf::TraversalCounters counters;
      (void)kerf::intersect(*bvh, (*rays)[i], counters);
      steps[i] = static_cast<std::uint32_t>(counters.steps);
      triangle_tests[i] = static_cast<std::uint32_t>(counters.triangle_tests);
    }
  });
}

// ---- Points and boxes ----

// 1 if there is a point within `max_distance`, else 0, or minus what went wrong.
KERF_EXPORT(closest_point) int closest_point(const Bvh* bvh, float x, float y, float z, float max_distance) {
  const int status = guarded([&] {
    surface_point = bvh->closest_point({x, y, z}, max_distance).value_or(kerf::SurfacePoint());
  });
  return status != 0 ? -status : surface_point ? 1 : 0;
}

KERF_EXPORT(closest_point_many)
int closest_point_many(const Bvh* bvh, const float* points, std::uint32_t count, float max_distance,
                       float* positions, float* distances, float* u, float* v, std::uint32_t* primitives) {
  return guarded([&] {
    std::vector<kerf::SurfacePoint> found(count);
    bvh->closest_point(points_of(points, count), found, max_distance);
    for (std::uint32_t i = 0; i < count; ++i) {
      const kerf::SurfacePoint& at = found[i];
      for (int axis = 0; axis < 3; ++axis)
        positions[3 * i + static_cast<std::uint32_t>(axis)] = at.position[axis];
      distances[i] = at.distance;
      u[i] = at.u;
      v[i] = at.v;
      primitives[i] = at.primitive;
    }
  });
}

KERF_EXPORT(contains_many)
int contains_many(const Bvh* bvh, const float* points, std::uint32_t count, std::uint8_t* flags) {
  return guarded([&] { bvh->contains(points_of(points, count), kerf::FlagView(flags, count)); });
}
KERF_EXPORT(side_many)
int side_many(const Bvh* bvh, const float* points, std::uint32_t count, kerf::Side* sides) {
  return guarded([&] { bvh->side(points_of(points, count), std::span(sides, count)); });
}
KERF_EXPORT(signed_distance_many)
int signed_distance_many(const Bvh* bvh, const float* points, std::uint32_t count, float* distances) {
  return guarded([&] { bvh->signed_distance(points_of(points, count), std::span(distances, count)); });
}

// The items are surface points.
KERF_EXPORT(nearest_many)
int nearest_many(const Bvh* bvh, const float* points, std::uint32_t count, std::uint32_t wanted,
                 float max_distance) {
  return guarded([&] { answer(bvh->nearest(points_of(points, count), wanted, max_distance)); });
}
KERF_EXPORT(within_many)
int within_many(const Bvh* bvh, const float* points, std::uint32_t count, float radius) {
  return guarded([&] { answer(bvh->within(points_of(points, count), radius)); });
}
// The items are pairs of a triangle and 0.
KERF_EXPORT(triangles_in) int triangles_in(const Bvh* bvh, const kerf::Box3f* boxes, std::uint32_t count) {
  return guarded([&] { answer(bvh->triangles_in(std::span(boxes, count))); });
}

// The transform is twelve doubles, row by row. 1 or 0, or minus what went wrong.
KERF_EXPORT(touches) int touches(const Bvh* bvh, const Bvh* other, const kerf::Transform* transform) {
  bool touch = false;
  const int status = guarded([&] { touch = bvh->touches(*other, *transform); });
  return status != 0 ? -status : touch ? 1 : 0;
}
// The items are twice a triangle and 0.
KERF_EXPORT(touching_pairs)
int touching_pairs(const Bvh* bvh, const Bvh* other, const kerf::Transform* transform) {
  return guarded(
      [&] { answer(std::span<const kerf::TouchingPair>(bvh->touching_pairs(*other, *transform))); });
}
