#include "workbench/formats/gltf/primitive.hpp"

#include <algorithm>

#include "workbench/formats/gltf/draco.hpp"

namespace workbench::gltf {
namespace {

using kerf::Error;

/// Indices that are read at once.
constexpr std::uint64_t indices_at_once = 3 * 1024;

Primitive::Kind kind_of(const Document& document, const Object& object) {
  const std::uint64_t mode = document.find_whole(object, "mode").value_or(4);
  if (mode > 6) document.raise("{}.mode: {} is not known", object.name, mode);
  constexpr Primitive::Kind kinds[] = {Primitive::Kind::other, Primitive::Kind::triangles,
                                       Primitive::Kind::strip, Primitive::Kind::fan};
  return mode < 4 ? kinds[0] : kinds[mode - 3];
}

// Reads the attributes of a primitive, from accessors or as Draco unpacks them.
class AttributeReader {
 public:
  AttributeReader(const Document& document, Buffers& buffers, const Object& primitive)
      : document_(document), buffers_(buffers), attributes_(document.object(primitive, "attributes")) {
    if (const auto packed = document.find_extension(primitive, "KHR_draco_mesh_compression")) {
      const Buffers::View view = buffers.view(document.whole(*packed, "bufferView"), packed->name);
      draco_.emplace(document, view.bytes, packed->name);
      draco_attributes_ = document.find_object(*packed, "attributes");
    }
  }

  std::optional<Elements> find(const char* name) {
    const auto accessor = document_.find_whole(attributes_, name);
    if (!accessor) return std::nullopt;
    const auto number = draco_attributes_ ? document_.find_whole(*draco_attributes_, name) : std::nullopt;
    if (!number) return read_accessor(document_, buffers_, *accessor, attributes_.name);
    return draco_->attribute(*number, declared_accessor(document_, *accessor, attributes_.name));
  }

  const std::vector<std::uint32_t>* unpacked_indices() const { return draco_ ? &draco_->indices() : nullptr; }

 private:
  const Document& document_;
  Buffers& buffers_;
  Object attributes_;
  std::optional<DracoMesh> draco_;
  std::optional<Object> draco_attributes_;
};

void read_influences(const Document& document, AttributeReader& attributes, Primitive& primitive) {
  for (int set = 0;; ++set) {
    auto joints = attributes.find(fmt::format("JOINTS_{}", set).c_str());
    auto weights = attributes.find(fmt::format("WEIGHTS_{}", set).c_str());
    if (!joints || !weights) return;
    require_components(document, *joints, 4);
    require_unsigned(document, *joints, primitive.name + ": joints");
    require_components(document, *weights, 4);
    if (joints->count < primitive.positions.count || weights->count < primitive.positions.count)
      document.raise("{}: set {} of joints and weights is of fewer vertices than there are", primitive.name,
                     set);
    primitive.influences.emplace_back(std::move(*joints), std::move(*weights));
  }
}

}  // namespace

Primitive read_primitive(const Document& document, Buffers& buffers, const Object& object) {
  Primitive primitive;
  primitive.name = object.name;
  primitive.kind = kind_of(document, object);
  if (primitive.kind == Primitive::Kind::other) return primitive;
  AttributeReader attributes(document, buffers, object);
  auto positions = attributes.find("POSITION");
  if (!positions) return primitive;  // glTF 2.0, section 3.7.2.1: there is nothing to show
  primitive.positions = std::move(*positions);
  require_components(document, primitive.positions, 3);
  read_influences(document, attributes, primitive);

  const Json& targets = document.list(object, "targets");
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Object target = document.to_object(targets[i], fmt::format("{}.targets[{}]", object.name, i));
    std::optional<Elements>& moves = primitive.targets.emplace_back();
    const auto accessor = document.find_whole(target, "POSITION");
    if (!accessor) continue;
    moves = read_accessor(document, buffers, *accessor, target.name);
    require_components(document, *moves, 3);
    if (moves->count < primitive.positions.count)
      document.raise("{}: {} vertices, but the primitive has {}", target.name, moves->count,
                     primitive.positions.count);
  }

  if (const auto* unpacked = attributes.unpacked_indices()) {
    primitive.unpacked_indices = *unpacked;
    primitive.kind = Primitive::Kind::triangles;
    primitive.corners = unpacked->size();
  } else if (const auto indices = document.find_whole(object, "indices")) {
    primitive.indices = read_accessor(document, buffers, *indices, object.name);
    require_components(document, *primitive.indices, 1);
    require_unsigned(document, *primitive.indices, object.name + ": indices");
    primitive.corners = primitive.indices->count;
  } else {
    primitive.corners = primitive.positions.count;
  }
  primitive.triangles = primitive.kind == Primitive::Kind::triangles
                            ? primitive.corners / 3
                            : std::max<std::uint64_t>(primitive.corners, 2) - 2;
  return primitive;
}

void append_triangles(const Document& document, const Primitive& primitive, std::uint32_t first_vertex,
                      std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const auto read = [&](std::uint64_t first, std::uint64_t count, std::uint32_t* corners) {
    if (primitive.unpacked_indices) {
      std::copy_n(primitive.unpacked_indices->begin() + static_cast<std::ptrdiff_t>(first), count, corners);
    } else if (primitive.indices) {
      primitive.indices->read(first, count, corners);
    } else {
      for (std::uint64_t i = 0; i < count; ++i) corners[i] = static_cast<std::uint32_t>(first + i);
    }
    std::uint32_t largest = 0;
    for (std::uint64_t i = 0; i < count; ++i) largest = std::max(largest, corners[i]);
    if (largest >= primitive.positions.count) {
      const auto wrong = std::find_if(corners, corners + count, [&](std::uint32_t corner) {
        return corner >= primitive.positions.count;
      });
      document.raise(Error::index_out_of_range, "{}: index {} names vertex {}, but there are {}",
                     primitive.name, first + static_cast<std::uint64_t>(wrong - corners), *wrong,
                     primitive.positions.count);
    }
    for (std::uint64_t i = 0; i < count; ++i) corners[i] += first_vertex;
  };
  const std::size_t begin = triangles.size();
  if (primitive.kind == Primitive::Kind::triangles) {
    triangles.resize(begin + primitive.triangles);
    for (std::uint64_t i = 0; i < 3 * primitive.triangles; i += indices_at_once)
      read(i, std::min(indices_at_once, 3 * primitive.triangles - i), triangles[begin + i / 3].data());
    return;
  }
  if (primitive.triangles == 0) return;
  triangles.reserve(begin + primitive.triangles);
  std::uint32_t a, b, c;
  read(0, 1, &a);
  read(1, 1, &b);
  for (std::uint64_t i = 0; i < primitive.triangles; ++i) {
    read(i + 2, 1, &c);
    // glTF 2.0, section 3.7.2.1: every second triangle of a strip goes round the other way.
    if (primitive.kind == Primitive::Kind::fan) {
      triangles.push_back({b, c, a});
    } else {
      triangles.push_back(i % 2 == 0 ? std::array{a, b, c} : std::array{b, a, c});
      a = b;
    }
    b = c;
  }
}

}  // namespace workbench::gltf
