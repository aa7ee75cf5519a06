#include "workbench/formats/read_gltf.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "workbench/formats/gltf/accessors.hpp"
#include "workbench/formats/gltf/buffers.hpp"
#include "workbench/formats/gltf/document.hpp"
#include "workbench/formats/gltf/extensions.hpp"
#include "workbench/formats/gltf/nodes.hpp"
#include "workbench/formats/gltf/primitive.hpp"
#include "workbench/formats/gltf/transform.hpp"
#include "workbench/formats/large_vector.hpp"
#include "workbench/formats/text.hpp"

namespace workbench {
namespace {

using namespace gltf;
using kerf::Error;

/// Vertices that are read and moved at once.
constexpr std::uint64_t vertices_at_once = 256;

using Point = std::array<double, 3>;

struct Mesh {
  std::vector<Primitive> primitives;
  std::vector<double> weights;  ///< of its morph targets, unless a node has its own
  std::uint64_t triangles = 0, vertices = 0;
};

class GltfReader {
 public:
  GltfReader(const std::filesystem::path& file, std::string_view json,
             std::optional<std::string_view> binary_chunk, std::uint64_t max_triangles)
      : document_(file, json), buffers_(document_, binary_chunk), max_triangles_(max_triangles) {}

  ReadMesh read() {
    const std::vector<Draw> draws = read_draws();
    check_sizes(draws);
    reserve_large(mesh_.triangles, triangles_);
    reserve_large(mesh_.vertices, vertices_);
    for (const Draw& draw : draws) append(draw);
    tell(draws);
    return std::move(mesh_);
  }

  GltfMeshes read_meshes() {
    const std::vector<Draw> draws = read_draws();
    const auto [once, often] = divide(draws);
    std::vector<Draw> all = once;
    for (Draw draw : often) {
      draw.transforms.resize(1);  // as much as it takes
      all.push_back(std::move(draw));
    }
    check_sizes(all);
    GltfMeshes result;
    const auto take = [&] { result.meshes.push_back(std::exchange(mesh_, {})); };
    for (const Draw& draw : once) append(draw);
    const bool has_others = !mesh_.triangles.empty() || often.empty();
    if (has_others) take();
    if (has_others && !often.empty()) result.places.push_back({0});
    mesh_ = {};
    for (const Draw& draw : often) {
      const auto number = static_cast<std::uint32_t>(result.meshes.size());
      for (const Transform& transform : draw.transforms)
        result.places.push_back({number, to_kerf(transform)});
      Draw unmoved = draw;
      unmoved.transforms = {Transform()};
      append(unmoved);
      take();
    }
    tell(draws);
    result.contents = std::move(mesh_.contents);
    return result;
  }

 private:
  // A mesh as a node shows it.
  struct Draw {
    std::uint64_t node, mesh;
    std::vector<Transform> transforms;  ///< of its instances
    std::optional<std::uint64_t> skin;
  };

  struct Divided {
    std::vector<Draw> once, often;  ///< those shown often have the transforms of all nodes that show them
  };

  std::vector<Draw> read_draws() {
    check_extensions();
    // All of the file is checked, not only what the scene shows of it.
    for (std::uint64_t i = 0; i < document_.count("meshes"); ++i) meshes_.push_back(read_mesh(i));
    nodes_ = read_nodes(document_);
    std::vector<Draw> draws;
    for (const std::uint64_t node : nodes_.in_scene) add_draws(node, draws);
    return draws;
  }

  // What may stand at several places, by mesh and weights of morph targets.
  Divided divide(const std::vector<Draw>& draws) const {
    using Key = std::pair<std::uint64_t, std::vector<double>>;
    const auto key_of = [&](const Draw& draw) {
      return Key(draw.mesh, weights_of(document_.item("nodes", draw.node, "nodes")));
    };
    const auto is_movable = [&](const Draw& draw, const Transform& transform) {
      return !draw.skin && meshes_[draw.mesh].triangles != 0 && is_invertible(transform);
    };
    std::map<Key, std::size_t> counts;
    for (const Draw& draw : draws)
      for (const Transform& transform : draw.transforms)
        if (is_movable(draw, transform)) ++counts[key_of(draw)];
    // A place takes the memory of about four triangles, and rays take longer to enter it: where nothing is
    // saved, triangles are copied.
    constexpr std::uint64_t triangles_of_a_place = 4;
    const auto is_kept = [&](const Key& key) {
      const std::uint64_t count = counts[key];
      return count > 1 && (count - 1) * meshes_[key.first].triangles > count * triangles_of_a_place;
    };
    Divided divided;
    std::map<Key, std::size_t> places;  // in `often`
    for (const Draw& draw : draws) {
      const Key key = key_of(draw);
      Draw rest = draw;
      rest.transforms.clear();
      for (const Transform& transform : draw.transforms) {
        if (!is_movable(draw, transform) || !is_kept(key)) {
          rest.transforms.push_back(transform);
          continue;
        }
        const auto [at, is_new] = places.try_emplace(key, divided.often.size());
        if (is_new) {
          divided.often.push_back(draw);
          divided.often.back().transforms.clear();
        }
        divided.often[at->second].transforms.push_back(transform);
      }
      if (!rest.transforms.empty()) divided.once.push_back(std::move(rest));
    }
    return divided;
  }

  static kerf::Transform to_kerf(const Transform& transform) {
    kerf::Transform to;
    for (std::size_t i = 0; i < 3; ++i) std::copy_n(transform.rows[i].data(), 4, to.rows[i]);
    return to;
  }

  // Far from what kerf refuses in a scene: by the sums of the rows of |M| |M^-1|.
  static bool is_invertible(const Transform& transform) {
    const auto& m = transform.rows;
    const auto minor = [&](std::size_t i, std::size_t j) {
      const std::size_t r = (i + 1) % 3, s = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      return m[r][c] * m[s][d] - m[r][d] * m[s][c];
    };
    const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    constexpr double max_sum = 0x1p16;
    for (std::size_t i = 0; i < 3; ++i) {
      double sum = 0.0;
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t k = 0; k < 3; ++k) sum += std::abs(m[i][k] * minor(j, k) / determinant);
      if (!(sum < max_sum) || !(std::abs(m[i][3]) < 0x1p100)) return false;
    }
    return true;
  }

  void check_extensions() const {
    for (const Json& name : document_.list(document_.root(), "extensionsRequired")) {
      if (!name.is_string()) document_.raise("extensionsRequired: names should stand here");
      const auto& extension = name.get_ref<const std::string&>();
      if (!is_understood(extension))
        document_.raise("requires the extension {}, which is not known", shown(extension));
    }
  }

  Mesh read_mesh(std::uint64_t number) {
    const Object object = document_.item("meshes", number, "meshes");
    Mesh mesh;
    const Json& primitives = document_.list(object, "primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const std::string name = fmt::format("{}.primitives[{}]", object.name, i);
      const Object of_primitive = document_.to_object(primitives[i], name);
      Primitive primitive = read_primitive(document_, buffers_, of_primitive);
      is_draco_ += primitive.unpacked_indices.has_value();
      points_or_lines_ += primitive.kind == Primitive::Kind::other;
      too_few_corners_ += primitive.kind != Primitive::Kind::other && primitive.positions.count != 0 &&
                          (primitive.triangles == 0 ||
                           (primitive.kind == Primitive::Kind::triangles && primitive.corners % 3 != 0));
      if (primitive.triangles == 0) continue;
      mesh.triangles += primitive.triangles;
      mesh.vertices += primitive.positions.count;
      mesh.primitives.push_back(std::move(primitive));
    }
    mesh.weights = weights_of(object);
    return mesh;
  }

  std::vector<double> weights_of(const Object& object) const {
    std::vector<double> weights;
    for (const Json& weight : document_.list(object, "weights"))
      weights.push_back(document_.to_number(weight, object.name));
    return weights;
  }

  void add_draws(std::uint64_t number, std::vector<Draw>& draws) {
    const Object node = document_.item("nodes", number, "nodes");
    const auto mesh = document_.find_whole(node, "mesh");
    if (!mesh) return;
    document_.item("meshes", *mesh, node.name);
    Draw draw{.node = number,
              .mesh = *mesh,
              .transforms = {nodes_.transforms[number]},
              .skin = document_.find_whole(node, "skin")};
    if (const auto instancing = document_.find_extension(node, "EXT_mesh_gpu_instancing")) {
      if (draw.skin) document_.raise("{}: instances of a mesh with a skin are not known", instancing->name);
      draw.transforms = instances(*instancing, draw.transforms[0]);
      instanced_ += draw.transforms.size();
    }
    draws.push_back(std::move(draw));
  }

  // EXT_mesh_gpu_instancing: a translation, a rotation and a scale for each instance, any of which may be
  // absent.
  std::vector<Transform> instances(const Object& instancing, const Transform& of_node) {
    const Object attributes = document_.object(instancing, "attributes");
    std::optional<Elements> found[3];
    constexpr std::pair<const char*, std::uint64_t> names[] = {
        {"TRANSLATION", 3}, {"ROTATION", 4}, {"SCALE", 3}};
    std::optional<std::uint64_t> count;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto accessor = document_.find_whole(attributes, names[i].first);
      if (!accessor) continue;
      found[i] = read_accessor(document_, buffers_, *accessor, attributes.name);
      require_components(document_, *found[i], names[i].second);
      if (count && *count != found[i]->count)
        document_.raise("{}: its attributes have different counts, {} and {}", attributes.name, *count,
                        found[i]->count);
      count = found[i]->count;
    }
    if (!count) return {of_node};
    std::vector<Transform> transforms;
    transforms.reserve(*count);
    for (std::uint64_t i = 0; i < *count; ++i) {
      std::array<double, 3> translation{0, 0, 0}, scale{1, 1, 1};
      std::array<double, 4> rotation{0, 0, 0, 1};
      if (found[0]) found[0]->read(i, 1, translation.data());
      if (found[1]) found[1]->read(i, 1, rotation.data());
      if (found[2]) found[2]->read(i, 1, scale.data());
      transforms.push_back(of_node * from_parts(translation, rotation, scale));
    }
    return transforms;
  }

  void check_sizes(const std::vector<Draw>& draws) {
    for (const Draw& draw : draws) {
      const Mesh& mesh = meshes_[draw.mesh];
      const std::uint64_t copies = draw.transforms.size();
      constexpr std::uint64_t max_vertices = std::numeric_limits<std::uint32_t>::max();
      if (mesh.triangles != 0 && (copies > max_triangles_ / mesh.triangles ||
                                  copies * mesh.triangles > max_triangles_ - triangles_)) {
        document_.raise(Error::too_large,
                        "nodes[{}]: with its {} instances there would be more than {} triangles", draw.node,
                        copies, max_triangles_);
      }
      if (mesh.vertices != 0 &&
          (copies > max_vertices / mesh.vertices || copies * mesh.vertices > max_vertices - vertices_))
        document_.raise(Error::too_large,
                        "nodes[{}]: with its {} instances there would be 2^32 vertices or more", draw.node,
                        copies);
      triangles_ += copies * mesh.triangles;
      vertices_ += copies * mesh.vertices;
    }
  }

  void append(const Draw& draw) {
    const Object node = document_.item("nodes", draw.node, "nodes");
    std::vector<double> weights = weights_of(node);
    const Mesh& mesh = meshes_[draw.mesh];
    if (weights.empty()) weights = mesh.weights;
    const std::vector<Transform> joints =
        draw.skin ? joint_transforms(*draw.skin, node.name) : std::vector<Transform>();
    for (const Transform& transform : draw.transforms) {
      for (const Primitive& primitive : mesh.primitives) {
        const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
        const bool has_skin = draw.skin && !primitive.influences.empty();
        append_vertices(primitive, weights, transform, has_skin ? &joints : nullptr);
        append_triangles(document_, primitive, first, mesh_.triangles);
      }
    }
  }

  // Where each joint of a skin moves points (glTF 2.0, section 3.7.3.1). Without inverse bind matrices, the
  // mesh has been made in the space of the joints.
  std::vector<Transform> joint_transforms(std::uint64_t number, std::string_view by) {
    const Object skin = document_.item("skins", number, by);
    const Json& joints = document_.list(skin, "joints");
    std::optional<Elements> inverses;
    if (const auto accessor = document_.find_whole(skin, "inverseBindMatrices")) {
      inverses = read_accessor(document_, buffers_, *accessor, skin.name);
      require_components(document_, *inverses, 16);
      if (inverses->count < joints.size())
        document_.raise("{}: {} inverse bind matrices for {} joints", skin.name, inverses->count,
                        joints.size());
    }
    std::vector<Transform> transforms;
    transforms.reserve(joints.size());
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const std::uint64_t node = document_.to_whole(joints[i], skin.name);
      document_.item("nodes", node, skin.name);
      std::array<double, 16> columns{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
      if (inverses) inverses->read(i, 1, columns.data());
      transforms.push_back(nodes_.transforms[node] * from_columns(columns));
    }
    return transforms;
  }

  // The vertices of a primitive: moved by its morph targets, then by its joints, or else by `transform`.
  void append_vertices(const Primitive& primitive, const std::vector<double>& weights,
                       const Transform& transform, const std::vector<Transform>* joints) {
    std::vector<std::pair<const Elements*, double>> moves;
    for (std::size_t i = 0; i < std::min(weights.size(), primitive.targets.size()); ++i) {
      if (primitive.targets[i] && weights[i] != 0.0) moves.emplace_back(&*primitive.targets[i], weights[i]);
    }
    const Elements& positions = primitive.positions;
    const std::uint64_t count = positions.count;
    posed_ += !moves.empty();
    skinned_ += joints != nullptr;
    const bool stays = joints == nullptr && transform == Transform();
    if (stays && moves.empty() && positions.are_plain_points() &&
        std::endian::native == std::endian::little) {
      const auto first = mesh_.vertices.size();
      mesh_.vertices.resize(first + count);
      if (count != 0)
        std::memcpy(static_cast<void*>(&mesh_.vertices[first]), positions.data, count * sizeof(kerf::Vec3f));
      if (!mesh_.remainders.empty()) mesh_.remainders.resize(mesh_.vertices.size());
      return;
    }
    std::array<Point, vertices_at_once> points, added;
    for (std::uint64_t begin = 0; begin < count; begin += vertices_at_once) {
      const std::uint64_t some = std::min(vertices_at_once, count - begin);
      positions.read(begin, some, points[0].data());
      for (const auto& [move, weight] : moves) {
        move->read(begin, some, added[0].data());
        for (std::uint64_t i = 0; i < some; ++i) {
          for (std::size_t axis = 0; axis < 3; ++axis) points[i][axis] += weight * added[i][axis];
        }
      }
      if (joints != nullptr) {
        pose(primitive, *joints, begin, std::span(points).first(some));
      } else if (!stays) {
        for (Point& p : std::span(points).first(some)) p = transform(p);
      }
      for (const auto& [x, y, z] : std::span(points).first(some)) mesh_.add_vertex(x, y, z);
    }
  }

  // A vertex is where the mean of its joints, by their weights, takes it.
  void pose(const Primitive& primitive, const std::vector<Transform>& joints, std::uint64_t begin,
            std::span<Point> points) const {
    for (std::size_t i = 0; i < points.size(); ++i) {
      Point sum{0, 0, 0};
      double total = 0.0;
      const auto add = [&](std::uint32_t joint, double weight) {
        if (joint >= joints.size()) {
          document_.raise(Error::index_out_of_range, "{}: vertex {} hangs on joint {}, but its skin has {}",
                          primitive.name, begin + i, joint, joints.size());
        }
        const Point moved = joints[joint](points[i]);
        for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += weight * moved[axis];
        total += weight;
      };
      std::uint32_t first_joint = 0;
      for (const auto& [of_joints, of_weights] : primitive.influences) {
        std::array<std::uint32_t, 4> numbers;
        std::array<double, 4> weights;
        of_joints.read(begin + i, 1, numbers.data());
        of_weights.read(begin + i, 1, weights.data());
        if (&of_joints == &primitive.influences[0].first) first_joint = numbers[0];
        for (std::size_t k = 0; k < 4; ++k) {
          if (weights[k] != 0.0) add(numbers[k], weights[k]);
        }
      }
      if (total == 0.0) {
        add(first_joint, 1.0);  // nothing to take the mean of
      }
      for (std::size_t axis = 0; axis < 3; ++axis) points[i][axis] = sum[axis] / total;
    }
  }

  void tell(const std::vector<Draw>& draws) {
    const auto tell = [&](std::uint64_t count, const char* name, std::string_view what) {
      if (count != 0) mesh_.contents.entries.push_back({name, fmt::format("{}{}", count, what)});
    };
    std::map<std::uint64_t, std::uint64_t> copies;
    for (const Draw& draw : draws) copies[draw.mesh] += draw.transforms.size();
    std::uint64_t shown_meshes = 0, repeated = 0;
    for (const auto& [mesh, count] : copies) {
      shown_meshes += count;
      repeated += count > 1;
    }
    if (repeated != 0) tell(shown_meshes, "instances", fmt::format(" of {} meshes", copies.size()));
    tell(instanced_, "of them", " by EXT_mesh_gpu_instancing");
    tell(skinned_, "skinned meshes", ", as their joints pose them");
    tell(posed_, "morphed meshes", ", as their default weights pose them");
    tell(is_draco_, "unpacked", " primitives by Draco");
    tell(buffers_.unpacked_views(), "unpacked", " buffer views by meshoptimizer");
    tell(document_.count("animations"), "animations", ", left out: the scene is shown at rest");
    if (document_.count("scenes") > 1)
      tell(document_.count("scenes"), "scenes",
           fmt::format(", shown is {}", document_.find_whole(document_.root(), "scene").value_or(0)));
    tell(meshes_.size() - copies.size(), "meshes left out", ", which the scene does not show");
    tell(nodes_.hidden, "nodes left out", ", hidden by KHR_node_visibility");
    tell(points_or_lines_, "primitives left out", ", of points or lines");
    tell(too_few_corners_, "incomplete", " primitives, whose last triangle lacks corners");
  }

  Document document_;
  Buffers buffers_;
  std::uint64_t max_triangles_;
  std::vector<Mesh> meshes_;
  Nodes nodes_;
  ReadMesh mesh_;
  std::uint64_t triangles_ = 0, vertices_ = 0;
  std::uint64_t instanced_ = 0, skinned_ = 0, posed_ = 0, is_draco_ = 0, points_or_lines_ = 0,
                too_few_corners_ = 0;
};

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 4; i-- > 0;) word = word << 8 | static_cast<unsigned char>(bytes[at + i]);
  return word;
}

// A header of magic, version and length is followed by chunks of length, type and bytes (glTF 2.0,
// section 4.4).
struct Chunks {
  std::string_view json;
  std::optional<std::string_view> binary;
  std::size_t others = 0, bytes_behind = 0;
};

Chunks read_chunks(const std::filesystem::path& file, std::string_view bytes) {
  constexpr std::size_t header_bytes = 12, chunk_header_bytes = 8;
  constexpr std::uint32_t json_type = 0x4e4f534a, binary_type = 0x004e4942;
  if (bytes.size() < header_bytes + chunk_header_bytes)
    raise(Error::bad_format, file, "truncated: has only {} bytes", bytes.size());
  if (word_at(bytes, 4) != 2)
    raise(Error::bad_format, file, "has version {}; only version 2 is known", word_at(bytes, 4));
  const std::size_t length = word_at(bytes, 8);
  if (length > bytes.size())
    raise(Error::bad_format, file, "truncated: the header promises {} bytes, but there are {}", length,
          bytes.size());
  Chunks chunks;
  chunks.bytes_behind = bytes.size() - length;
  bytes = bytes.substr(0, length);
  bool has_json = false;
  // Fewer bytes at the end than a chunk's header has are padding.
  for (std::size_t at = header_bytes; at + chunk_header_bytes <= bytes.size();) {
    const std::size_t size = word_at(bytes, at);
    const std::uint32_t type = word_at(bytes, at + 4);
    if (size > bytes.size() - at - chunk_header_bytes)
      raise(Error::bad_format, file, "truncated: the chunk at byte {} goes beyond the end at {}", at,
            bytes.size());
    const std::string_view chunk = bytes.substr(at + chunk_header_bytes, size);
    if (!has_json && type != json_type)
      raise(Error::bad_format, file, "byte {}: the first chunk is not JSON", at);
    if (!has_json) {
      chunks.json = chunk;
      has_json = true;
    } else if (type == binary_type && !chunks.binary) {
      chunks.binary = chunk;
    } else {
      ++chunks.others;
    }
    at += chunk_header_bytes + size;
  }
  if (!has_json) raise(Error::bad_format, file, "truncated: has no JSON chunk");
  // Padding with zeros is wrong, but clear.
  chunks.json = chunks.json.substr(0, chunks.json.find_last_not_of('\0') + 1);
  return chunks;
}

}  // namespace

namespace {

// What `read(reader)` makes of a file, which has contents.
template <class Read>
auto read_with(const std::filesystem::path& file, const FileBytes& file_bytes, std::uint64_t max_triangles,
               const Read& read) {
  const std::string_view bytes = file_bytes.view();
  // Files of one kind with the name of the other are frequent, and clear.
  if (!bytes.starts_with("glTF")) {
    GltfReader reader(file, without_byte_order_mark(bytes), std::nullopt, max_triangles);
    return read(reader);
  }
  const Chunks chunks = read_chunks(file, bytes);
  GltfReader reader(file, chunks.json, chunks.binary, max_triangles);
  auto result = read(reader);
  const auto tell = [&](std::size_t count, const char* name, const char* what) {
    if (count != 0) result.contents.entries.push_back({name, fmt::format("{}{}", count, what)});
  };
  tell(chunks.others, "chunks left out", ", of unknown types");
  tell(chunks.bytes_behind, "bytes left out", ", behind the end that the header names");
  return result;
}

}  // namespace

ReadMesh read_gltf(const std::filesystem::path& file, const FileBytes& bytes, std::uint64_t max_triangles) {
  return read_with(file, bytes, max_triangles, [](GltfReader& reader) { return reader.read(); });
}

GltfMeshes read_gltf_meshes(const std::filesystem::path& file, const FileBytes& bytes,
                            std::uint64_t max_triangles) {
  return read_with(file, bytes, max_triangles, [](GltfReader& reader) { return reader.read_meshes(); });
}

}  // namespace workbench
