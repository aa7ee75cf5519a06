// Arrays of other libraries in the memory of a device, as kerf reads and writes them: without a copy, after a
// check of everything that could be wrong with them. CuPy, PyTorch, JAX and Numba describe theirs through
// DLPack (dmlc.github.io/dlpack) or `__cuda_array_interface__`. This header needs neither of these nor the
// CUDA Toolkit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <kerf/cuda/error.hpp>
#include <kerf/mesh.hpp>
#include <kerf/query.hpp>
#include <kerf/ray.hpp>

namespace kerf::cuda {

/// The structures of DLPack as its documentation lays them out in memory, since version 0.6 and, with
/// `Versioned`, 1.0. A capsule named "dltensor" holds a `Managed`, one named "dltensor_versioned" a
/// `Versioned`.
namespace dlpack {

enum DeviceType : std::int32_t { cpu = 1, cuda = 2, cuda_host = 3, cuda_managed = 13 };
enum TypeCode : std::uint8_t { signed_integer = 0, unsigned_integer = 1, floating = 2, boolean = 6 };

struct Device {
  std::int32_t type;  // a `DeviceType`, or of other hardware
  std::int32_t id;
};
struct DataType {
  std::uint8_t code;  // a `TypeCode`, or another
  std::uint8_t bits;
  std::uint16_t lanes;
};
struct Tensor {
  void* data;
  Device device;
  std::int32_t dimensions;
  DataType type;
  std::int64_t* shape;
  std::int64_t* strides;  // in elements; null for rows one after another
  std::uint64_t byte_offset;
};
struct Managed {
  Tensor tensor;
  void* manager;
  void (*deleter)(Managed*);
};
struct Versioned {
  std::uint32_t major, minor;
  void* manager;
  void (*deleter)(Versioned*);
  std::uint64_t flags;
  Tensor tensor;
};
inline constexpr std::uint64_t read_only_flag = 1;

static_assert(sizeof(void*) != 8 ||
              (sizeof(Tensor) == 48 && sizeof(Managed) == 64 && sizeof(Versioned) == 80));

}  // namespace dlpack

/// The entries of a `__cuda_array_interface__`, version 2 or 3.
struct CudaArrayInterface {
  std::span<const std::int64_t> shape = {};
  std::string_view typestr = {};               ///< `"<f4"`
  std::uintptr_t data = 0;                     ///< the first part of `data`
  bool read_only = false;                      ///< the second part
  std::span<const std::int64_t> strides = {};  ///< in bytes; empty for None
  std::optional<std::uintptr_t> stream = {};   ///< on which the array is written; none for None
  bool has_mask = false;                       ///< whether there is a `mask` other than None
};

/// An array as its owner describes it. Refers to the owner's memory, and keeps nothing alive.
class ForeignArray {
 public:
  /// Of a tensor that lies on a CUDA device. `name` stands in the sentences of errors. Throws `Error` for a
  /// tensor elsewhere, or of a shape or type that is no array's.
  ForeignArray(std::string name, const dlpack::Tensor& tensor, bool read_only = false);

  ForeignArray(std::string name, const dlpack::Managed& managed) : ForeignArray(name, managed.tensor) {}

  /// Throws also for a major version other than 1.
  ForeignArray(std::string name, const dlpack::Versioned& versioned);

  /// The interface does not say on which device an array lies: `device` is asked for from CUDA
  /// (`cudaPointerGetAttributes`) or known. Throws also for a mask, and for stream 0, which the interface
  /// forbids.
  ForeignArray(std::string name, const CudaArrayInterface& interface, int device);

  /// The array as elements of `T`, which follow one another without gaps: of `Ray` a shape of (n, 8), of
  /// `Hit` (n, 5), of `Vec3f` (n, 3), of `SurfacePoint` (n, 8), of a number (n).
  ///
  /// Numbers must be floats where all of `T` are; those of `Hit` and `SurfacePoint`, which mix both, may be
  /// of any type of 32 bits. Integers may be signed or not; bytes may be bools. `T` is const, or the array
  /// can be written. `device` is the one that the hierarchy is on. Throws `Error` otherwise.
  template <class T>
  std::span<T> elements(int device) const;

  /// The array as positions of vertices or as numbers of a triangle's vertices, of shape (n, 3). Rows may
  /// have gaps between them.
  TripleView<float> vertices(int device) const { return triples<float>(device, "floats"); }
  TripleView<std::uint32_t> triangles(int device) const {
    return triples<std::uint32_t>(device, "integers of 32 bits");
  }

 private:
  enum class Kind { integer, floating, boolean };

  template <class Scalar>
  TripleView<Scalar> triples(int device, const char* wanted) const;

  static const dlpack::Tensor& tensor_of(const std::string& name, const dlpack::Versioned& versioned);
  void check_shape();
  void check_place(int device, std::size_t alignment) const;
  void check_columns(std::int64_t columns) const;
  std::string shape_text() const;
  std::size_t rows() const { return static_cast<std::size_t>(shape_[0]); }
  bool empty() const;

  [[noreturn]] void fail(const std::string& reason) const {
    throw Error("reading the array " + name_, reason);
  }

  std::string name_;
  std::uintptr_t data_ = 0;
  std::vector<std::int64_t> shape_, strides_;  // strides in bytes
  Kind kind_ = Kind::integer;
  std::int64_t size_ = 0;  // of a number, in bytes
  int device_ = 0;
  bool read_only_ = false;
};

/// Calls a capsule's deleter when it is done with the tensor.
template <class M>
class OwnedTensor {
 public:
  explicit OwnedTensor(M* managed) : managed_(managed) {}
  OwnedTensor(OwnedTensor&& other) noexcept : managed_(std::exchange(other.managed_, nullptr)) {}
  OwnedTensor& operator=(OwnedTensor&& other) noexcept {
    std::swap(managed_, other.managed_);
    return *this;
  }
  ~OwnedTensor() {
    if (managed_ != nullptr && managed_->deleter != nullptr) managed_->deleter(managed_);
  }
  const M& operator*() const { return *managed_; }

 private:
  M* managed_;
};

// ---------------------------------------------------------------------------------------------------------

inline ForeignArray::ForeignArray(std::string name, const dlpack::Tensor& tensor, bool read_only)
    : name_(std::move(name)), read_only_(read_only) {
  if (tensor.device.type != dlpack::cuda && tensor.device.type != dlpack::cuda_managed)
    fail("it does not lie on a CUDA device (DLPack's device type " + std::to_string(tensor.device.type) +
         ")");
  device_ = tensor.device.id;
  const dlpack::DataType type = tensor.type;
  const bool known = type.code == dlpack::signed_integer || type.code == dlpack::unsigned_integer ||
                     type.code == dlpack::floating || type.code == dlpack::boolean;
  if (!known || type.lanes != 1 || type.bits == 0 || type.bits % 8 != 0)
    fail("its type is neither an integer nor a float (DLPack's code " + std::to_string(type.code) + ", " +
         std::to_string(type.bits) + " bits, " + std::to_string(type.lanes) + " lanes)");
  kind_ = type.code == dlpack::floating  ? Kind::floating
          : type.code == dlpack::boolean ? Kind::boolean
                                         : Kind::integer;
  size_ = type.bits / 8;
  if (tensor.dimensions < 0 || (tensor.dimensions > 0 && tensor.shape == nullptr)) fail("it has no shape");
  const auto dimensions = static_cast<std::size_t>(tensor.dimensions);
  if (dimensions != 0) shape_.assign(tensor.shape, tensor.shape + dimensions);
  if (dimensions != 0 && tensor.strides != nullptr) {
    strides_.assign(tensor.strides, tensor.strides + dimensions);
    for (std::int64_t& stride : strides_) {
      if (__builtin_mul_overflow(stride, size_, &stride)) fail("its strides are too large");
    }
  }
  check_shape();
  data_ = reinterpret_cast<std::uintptr_t>(tensor.data);
  if (data_ != 0) data_ += static_cast<std::uintptr_t>(tensor.byte_offset);
}

// Of another major version not even the tensor's place is known.
inline const dlpack::Tensor& ForeignArray::tensor_of(const std::string& name,
                                                     const dlpack::Versioned& versioned) {
  if (versioned.major != 1)
    throw Error("reading the array " + name,
                "it is of version " + std::to_string(versioned.major) + " of DLPack, not 1");
  return versioned.tensor;
}

inline ForeignArray::ForeignArray(std::string name, const dlpack::Versioned& versioned)
    : ForeignArray(name, tensor_of(name, versioned), (versioned.flags & dlpack::read_only_flag) != 0) {}

inline ForeignArray::ForeignArray(std::string name, const CudaArrayInterface& interface, int device)
    : name_(std::move(name)), data_(interface.data), device_(device), read_only_(interface.read_only) {
  const std::string_view type = interface.typestr;
  const std::string said = "its type is neither an integer nor a float in the device's order of bytes (\"" +
                           std::string(type) + "\")";
  if (type.size() != 3 || type[2] < '1' || type[2] > '8') fail(said);
  size_ = type[2] - '0';
  if (type[0] != '<' && !(type[0] == '|' && size_ == 1)) fail(said);
  switch (type[1]) {
    case 'f':
      kind_ = Kind::floating;
      break;
    case 'b':
      kind_ = Kind::boolean;
      break;
    case 'i':
    case 'u':
      kind_ = Kind::integer;
      break;
    default:
      fail(said);
  }
  if (interface.has_mask) fail("it has a mask");
  if (interface.stream == std::uintptr_t{0}) fail("its stream is 0, which may be any of two");
  shape_.assign(interface.shape.begin(), interface.shape.end());
  strides_.assign(interface.strides.begin(), interface.strides.end());
  if (!strides_.empty() && strides_.size() != shape_.size())
    fail("it has " + std::to_string(shape_.size()) + " dimensions and " + std::to_string(strides_.size()) +
         " strides");
  check_shape();
}

inline void ForeignArray::check_shape() {
  // Sizes below this in bytes, so that no product of them overflows.
  constexpr std::int64_t max_bytes = std::int64_t{1} << 48;
  std::int64_t bytes = size_;
  for (const std::int64_t extent : shape_) {
    if (extent < 0) fail("its shape is " + shape_text());
    if (extent != 0 && bytes > max_bytes / extent) fail("it is too large: its shape is " + shape_text());
    bytes *= extent == 0 ? 1 : extent;
  }
  if (!strides_.empty()) return;
  strides_.resize(shape_.size());
  std::int64_t stride = size_;
  for (std::size_t i = shape_.size(); i-- > 0;) {
    strides_[i] = stride;
    stride *= shape_[i] == 0 ? 1 : shape_[i];
  }
}

inline std::string ForeignArray::shape_text() const {
  std::string text = "(";
  for (std::size_t i = 0; i < shape_.size(); ++i) text += (i == 0 ? "" : ", ") + std::to_string(shape_[i]);
  return text + ")";
}

inline bool ForeignArray::empty() const {
  for (const std::int64_t extent : shape_) {
    if (extent == 0) return true;
  }
  return false;
}

inline void ForeignArray::check_place(int device, std::size_t alignment) const {
  if (device_ != device)
    fail("it lies on device " + std::to_string(device_) + ", the hierarchy on device " +
         std::to_string(device));
  if (empty()) return;
  if (data_ == 0) fail("it has no address");
  if (data_ % alignment != 0) fail("its address is not a multiple of " + std::to_string(alignment));
}

inline void ForeignArray::check_columns(std::int64_t columns) const {
  const bool fits = columns == 1 ? shape_.size() == 1 : shape_.size() == 2 && shape_[1] == columns;
  if (fits) return;
  fail("its shape is " + shape_text() + ", not " +
       (columns == 1 ? std::string("(n)") : "(n, " + std::to_string(columns) + ")"));
}

template <class T>
std::span<T> ForeignArray::elements(int device) const {
  using Element = std::remove_const_t<T>;
  constexpr bool is_number = std::is_arithmetic_v<Element>;
  constexpr bool is_mixed = std::is_same_v<Element, Hit> || std::is_same_v<Element, SurfacePoint>;
  static_assert(is_number || is_mixed || std::is_same_v<Element, Ray> || std::is_same_v<Element, Vec3f>,
                "an array has elements of Ray, Hit, Vec3f, SurfacePoint or a number");
  constexpr std::int64_t number_size = is_number ? std::int64_t{sizeof(Element)} : 4;
  const bool is_right_kind = is_mixed ? kind_ != Kind::boolean
                             : is_number && std::is_integral_v<Element>
                                 ? kind_ == Kind::integer || (kind_ == Kind::boolean && number_size == 1)
                                 : kind_ == Kind::floating;
  if (!is_right_kind || size_ != number_size) {
    const char* kind = is_mixed                                   ? "numbers"
                       : is_number && std::is_integral_v<Element> ? "integers"
                                                                  : "floats";
    fail("it does not hold " + std::string(kind) + " of " + std::to_string(8 * number_size) + " bits");
  }
  check_columns(std::int64_t{sizeof(Element)} / number_size);
  if (!std::is_const_v<T> && read_only_) fail("it can only be read");
  check_place(device, alignof(Element));
  // A stride says something only where there is a next element.
  const bool rows_follow = shape_[0] <= 1 || strides_[0] == std::int64_t{sizeof(Element)};
  if (!empty() && !(rows_follow && (shape_.size() == 1 || strides_[1] == size_)))
    fail("its elements do not follow one another without gaps");
  return {reinterpret_cast<T*>(data_), rows()};
}

template <class Scalar>
TripleView<Scalar> ForeignArray::triples(int device, const char* wanted) const {
  const bool is_right_kind = kind_ == (std::is_integral_v<Scalar> ? Kind::integer : Kind::floating);
  if (!is_right_kind || size_ != std::int64_t{sizeof(Scalar)})
    fail(std::string("it does not hold ") + wanted);
  check_columns(3);
  check_place(device, alignof(Scalar));
  if (empty()) return {};
  if (strides_[1] != size_) fail("the numbers of a row do not follow one another without gaps");
  if (shape_[0] > 1 && (strides_[0] < 3 * size_ || strides_[0] % size_ != 0))
    fail("its rows lie " + std::to_string(strides_[0]) + " bytes apart");
  const auto stride = static_cast<std::size_t>(shape_[0] > 1 ? strides_[0] : 3 * size_);
  return {reinterpret_cast<const void*>(data_), rows(), stride};
}

}  // namespace kerf::cuda
