#include "workbench/formats/gltf/accessors.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

namespace workbench::gltf {
namespace {

/// Elements for which there are no bytes are zeros, except sparse ones. So many of them need no reason.
constexpr std::uint64_t max_zeros = std::uint64_t{1} << 16;

/// No offset or size comes near this: sums and products of two of them cannot wrap.
constexpr std::uint64_t max_elements = std::uint64_t{1} << 40;

std::uint64_t components_of(const Document& document, const Object& accessor) {
  const std::string& type = document.text(accessor, "type");
  constexpr std::pair<std::string_view, std::uint64_t> types[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  for (const auto& [name, components] : types) {
    if (name == type) return components;
  }
  document.raise("{}: '{}' is not a type of accessors", accessor.name, type.substr(0, 40));
}

ComponentType to_component_type(const Document& document, const Object& object) {
  const std::uint64_t number = document.whole(object, "componentType");
  if ((number >= 5120 && number <= 5126) || number == 5130) return static_cast<ComponentType>(number);
  document.raise("{}: component type {} is not known", object.name, number);
}

// The bytes of elements from byte `offset` of a view on, of which each begins `stride` bytes behind the last.
const char* elements_in(const Document& document, std::string_view name, const Buffers::View& view,
                        std::uint64_t offset, std::uint64_t count, std::uint64_t stride, std::uint64_t size) {
  if (count == 0) return nullptr;
  if (count > max_elements || offset > max_elements || stride > max_elements / count ||
      offset + (count - 1) * stride + size > view.bytes.size()) {
    document.raise("truncated: {}: {} elements of {} bytes from byte {} on cannot be in a view of {}", name,
                   count, size, offset, view.bytes.size());
  }
  return view.bytes.data() + offset;
}

// Sparse elements replace those of the same number.
void put_sparse(const Document& document, Buffers& buffers, const Object& sparse, Elements& elements,
                std::uint64_t size, std::string& bytes) {
  const std::uint64_t count = document.whole(sparse, "count");
  const Object of_indices = document.object(sparse, "indices"), of_values = document.object(sparse, "values");
  if (count > elements.count)
    document.raise("{}: count {} is out of range: there are {} elements", sparse.name, count, elements.count);
  Elements indices;
  indices.name = of_indices.name;
  indices.count = count;
  indices.type = to_component_type(document, of_indices);
  indices.stride = bytes_of(indices.type);
  require_unsigned(document, indices, of_indices.name + ": indices");
  const Buffers::View index_view = buffers.view(document.whole(of_indices, "bufferView"), of_indices.name);
  indices.data = elements_in(document, of_indices.name, index_view,
                             document.find_whole(of_indices, "byteOffset").value_or(0), count, indices.stride,
                             indices.stride);
  const Buffers::View value_view = buffers.view(document.whole(of_values, "bufferView"), of_values.name);
  const char* const values =
      elements_in(document, of_values.name, value_view,
                  document.find_whole(of_values, "byteOffset").value_or(0), count, size, size);
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint32_t index;
    indices.read(i, 1, &index);
    if (index >= elements.count) {
      document.raise(kerf::Error::index_out_of_range,
                     "{}: index {} is {}, out of range: there are {} elements", sparse.name, i, index,
                     elements.count);
    }
    std::memcpy(bytes.data() + index * size, values + i * size, size);
  }
}

// glTF keeps numbers with the lowest byte first.
template <class Number>
Number number_at(const char* from) {
  char bytes[sizeof(Number)];
  std::memcpy(bytes, from, sizeof(Number));
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes, bytes + sizeof(Number));
  return std::bit_cast<Number>(bytes);
}

template <class Number, class Out>
void convert(const Elements& elements, std::uint64_t first, std::uint64_t number, Out* out) {
  const char* at = elements.data + first * elements.stride;
  for (std::uint64_t i = 0; i < number; ++i, at += elements.stride) {
    for (std::uint64_t k = 0; k < elements.components; ++k) {
      const Number value = number_at<Number>(at + k * sizeof(Number));
      if constexpr (std::is_integral_v<Number> && std::is_floating_point_v<Out>) {
        // glTF 2.0, section 3.11: signed numbers are symmetric, so that the smallest one is clamped.
        const Out real = static_cast<Out>(value);
        *out++ = elements.is_normalized
                     ? std::max(real / static_cast<Out>(std::numeric_limits<Number>::max()), Out{-1})
                     : real;
      } else {
        *out++ = static_cast<Out>(value);
      }
    }
  }
}

}  // namespace

std::uint64_t bytes_of(ComponentType type) {
  switch (type) {
    case ComponentType::int8:
    case ComponentType::uint8:
      return 1;
    case ComponentType::int16:
    case ComponentType::uint16:
      return 2;
    case ComponentType::float64:
      return 8;
    default:
      return 4;
  }
}

void Elements::read(std::uint64_t first, std::uint64_t number, double* out) const {
  switch (type) {
    case ComponentType::int8:
      return convert<std::int8_t>(*this, first, number, out);
    case ComponentType::uint8:
      return convert<std::uint8_t>(*this, first, number, out);
    case ComponentType::int16:
      return convert<std::int16_t>(*this, first, number, out);
    case ComponentType::uint16:
      return convert<std::uint16_t>(*this, first, number, out);
    case ComponentType::int32:
      return convert<std::int32_t>(*this, first, number, out);
    case ComponentType::uint32:
      return convert<std::uint32_t>(*this, first, number, out);
    case ComponentType::float32:
      return convert<float>(*this, first, number, out);
    case ComponentType::float64:
      return convert<double>(*this, first, number, out);
  }
}

void Elements::read(std::uint64_t first, std::uint64_t number, std::uint32_t* out) const {
  switch (type) {
    case ComponentType::uint8:
      return convert<std::uint8_t>(*this, first, number, out);
    case ComponentType::uint16:
      return convert<std::uint16_t>(*this, first, number, out);
    default:
      return convert<std::uint32_t>(*this, first, number, out);
  }
}

Elements declared_accessor(const Document& document, std::uint64_t accessor, std::string_view by) {
  const Object object = document.item("accessors", accessor, by);
  Elements elements;
  elements.name = object.name;
  elements.count = document.whole(object, "count");
  elements.components = components_of(document, object);
  elements.type = to_component_type(document, object);
  elements.is_normalized = document.find_flag(object, "normalized", false);
  elements.stride = elements.components * bytes_of(elements.type);
  return elements;
}

Elements read_accessor(const Document& document, Buffers& buffers, std::uint64_t accessor,
                       std::string_view by) {
  const Object object = document.item("accessors", accessor, by);
  Elements elements = declared_accessor(document, accessor, by);
  const std::uint64_t size = elements.stride;
  const auto view_number = document.find_whole(object, "bufferView");
  const auto sparse = document.find_object(object, "sparse");
  if (view_number) {
    const Buffers::View view = buffers.view(*view_number, object.name);
    if (view.stride != 0) elements.stride = view.stride;
    elements.data =
        elements_in(document, object.name, view, document.find_whole(object, "byteOffset").value_or(0),
                    elements.count, elements.stride, size);
    if (!sparse) return elements;
  } else if (elements.count > std::max(max_zeros, buffers.total_bytes())) {
    document.raise("{}: a count of {} without bytes", object.name, elements.count);
  }
  std::string bytes(elements.count * size, '\0');
  if (elements.data != nullptr) {
    for (std::uint64_t i = 0; i < elements.count; ++i)
      std::memcpy(bytes.data() + i * size, elements.data + i * elements.stride, size);
  }
  if (sparse) put_sparse(document, buffers, *sparse, elements, size, bytes);
  elements.made = std::make_shared<const std::string>(std::move(bytes));
  elements.data = elements.made->data();
  elements.stride = size;
  return elements;
}

void require_unsigned(const Document& document, const Elements& elements, std::string_view where) {
  if (elements.type != ComponentType::uint8 && elements.type != ComponentType::uint16 &&
      elements.type != ComponentType::uint32)
    document.raise("{} of component type {}", where, static_cast<std::uint64_t>(elements.type));
}

void require_components(const Document& document, const Elements& elements, std::uint64_t components) {
  if (elements.components != components)
    document.raise("{}: elements of {} numbers stand where ones of {} should", elements.name,
                   elements.components, components);
}

}  // namespace workbench::gltf
