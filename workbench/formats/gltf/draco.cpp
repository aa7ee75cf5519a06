#include "workbench/formats/gltf/draco.hpp"

#include <algorithm>
#include <exception>
#include <utility>

// Its headers compare and convert as they like.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wextra"
#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>
#include <draco/mesh/mesh.h>
#pragma GCC diagnostic pop

namespace workbench::gltf {

struct DracoMesh::Unpacked {
  std::unique_ptr<draco::Mesh> mesh;
};

DracoMesh::~DracoMesh() = default;

DracoMesh::DracoMesh(const Document& document, std::string_view packed, std::string_view name)
    : document_(document), name_(name), unpacked_(std::make_unique<Unpacked>()) {
  std::string cause;
  try {
    draco::DecoderBuffer buffer;
    buffer.Init(packed.data(), packed.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (decoded.ok()) {
      unpacked_->mesh = std::move(decoded).value();
    } else {
      cause = decoded.status().error_msg_string();
    }
  } catch (const std::exception& e) {  // it takes as much memory as the data say
    cause = e.what();
  }
  std::replace(cause.begin(), cause.end(), '\n', ' ');
  if (!unpacked_->mesh) document.raise("{}: Draco cannot unpack it: {}", name, cause.substr(0, 100));
  const draco::Mesh& mesh = *unpacked_->mesh;
  indices_.reserve(3 * std::size_t{mesh.num_faces()});
  for (std::uint32_t face = 0; face < mesh.num_faces(); ++face) {
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(face))) {
      if (corner.value() >= mesh.num_points()) {
        document.raise(kerf::Error::index_out_of_range, "{}: face {} names vertex {}, but there are {}", name,
                       face, corner.value(), mesh.num_points());
      }
      indices_.push_back(corner.value());
    }
  }
}

Elements DracoMesh::attribute(std::uint64_t number, const Elements& declared) const {
  const draco::Mesh& mesh = *unpacked_->mesh;
  const draco::PointAttribute* const attribute =
      number <= UINT32_MAX ? mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(number)) : nullptr;
  if (attribute == nullptr) document_.raise("{}: Draco's data have no attribute {}", name_, number);
  if (static_cast<std::uint64_t>(attribute->num_components()) != declared.components) {
    document_.raise("{}: Draco's attribute {} has {} components, not {}", name_, number,
                    int{attribute->num_components()}, declared.components);
  }
  Elements elements = declared;
  elements.count = mesh.num_points();
  constexpr std::pair<draco::DataType, ComponentType> types[] = {
      {draco::DT_INT8, ComponentType::int8},       {draco::DT_UINT8, ComponentType::uint8},
      {draco::DT_INT16, ComponentType::int16},     {draco::DT_UINT16, ComponentType::uint16},
      {draco::DT_INT32, ComponentType::int32},     {draco::DT_UINT32, ComponentType::uint32},
      {draco::DT_FLOAT32, ComponentType::float32}, {draco::DT_FLOAT64, ComponentType::float64}};
  const auto type = std::find_if(std::begin(types), std::end(types),
                                 [&](const auto& t) { return t.first == attribute->data_type(); });
  if (type == std::end(types))
    document_.raise("{}: Draco's attribute {} is of type {}", name_, number, int{attribute->data_type()});
  elements.type = type->second;
  elements.stride = elements.components * bytes_of(elements.type);
  std::string bytes(elements.count * elements.stride, '\0');
  for (std::uint32_t point = 0; point < mesh.num_points(); ++point) {
    const draco::AttributeValueIndex value = attribute->mapped_index(draco::PointIndex(point));
    if (value.value() >= attribute->size())
      document_.raise(kerf::Error::index_out_of_range, "{}: Draco's attribute {} has no value {}", name_,
                      number, value.value());
    attribute->GetValue(value, bytes.data() + point * elements.stride);
  }
  elements.made = std::make_shared<const std::string>(std::move(bytes));
  elements.data = elements.made->data();
  return elements;
}

}  // namespace workbench::gltf
