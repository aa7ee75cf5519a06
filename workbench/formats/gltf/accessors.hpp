// Accessors: the elements of a glTF file, of whatever type they are kept as.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "workbench/formats/gltf/buffers.hpp"
#include "workbench/formats/gltf/document.hpp"

namespace workbench::gltf {

/// The component types of glTF 2.0, section 3.6.2.2, and those that extensions add.
enum class ComponentType : std::uint64_t {
  int8 = 5120,
  uint8 = 5121,
  int16 = 5122,
  uint16 = 5123,
  int32 = 5124,
  uint32 = 5125,
  float32 = 5126,
  float64 = 5130
};

/// The elements of an accessor.
struct Elements {
  std::string name;  ///< in errors
  std::uint64_t count = 0;
  std::uint64_t components = 1;  ///< of an element: 3 of a VEC3
  ComponentType type = ComponentType::float32;
  bool is_normalized = false;  ///< integers stand for numbers from -1 or 0 to 1
  const char* data = nullptr;
  std::uint64_t stride = 0;                 ///< bytes from one element to the next
  std::shared_ptr<const std::string> made;  ///< where `data` is, unless it is in the file

  /// Components of `number` elements from `first` on, one element behind another.
  void read(std::uint64_t first, std::uint64_t number, double* components) const;

  /// The same of unsigned integers, which `require_unsigned` has made sure of.
  void read(std::uint64_t first, std::uint64_t number, std::uint32_t* components) const;

  /// True if the elements lie one behind another as `float[3]`.
  bool are_plain_points() const { return type == ComponentType::float32 && components == 3 && stride == 12; }
};

std::uint64_t bytes_of(ComponentType type);

/// The elements of an accessor, with its sparse values in place. All bytes are there.
Elements read_accessor(const Document& document, Buffers& buffers, std::uint64_t accessor,
                       std::string_view by);

/// What an accessor says of its elements, without their bytes.
Elements declared_accessor(const Document& document, std::uint64_t accessor, std::string_view by);

/// Throws unless the components are unsigned integers. `where` names what is of another type: "indices".
void require_unsigned(const Document& document, const Elements& elements, std::string_view where);

/// Throws unless elements are of that many components.
void require_components(const Document& document, const Elements& elements, std::uint64_t components);

}  // namespace workbench::gltf
