#include "cuda_arrays.hpp"

#include <array>
#include <string_view>
#include <vector>

namespace kerf::python {
namespace {

namespace dlpack = cuda::dlpack;

// The stream as DLPack and the interface name it: 1 is the default stream, and 0 is nobody.
std::uintptr_t number_of(Stream stream) {
  return stream == nullptr ? 1 : reinterpret_cast<std::uintptr_t>(stream);
}

// What the exception of another library says, in one line.
std::string sentence_of(const nb::python_error& error) {
  const std::string text = nb::str(error.value()).c_str();
  return text.substr(0, text.find('\n'));
}

template <class M>
cuda::OwnedTensor<M> owned(PyObject* capsule, const char* name, const char* used) {
  auto* managed = static_cast<M*>(PyCapsule_GetPointer(capsule, name));
  if (managed == nullptr || PyCapsule_SetName(capsule, used) != 0) throw nb::python_error();
  return cuda::OwnedTensor<M>(managed);
}

template <class M>
struct Export {
  M managed{};
  std::array<std::int64_t, 2> shape{}, strides{};
  std::shared_ptr<DeviceMemory> memory;
};

template <class M>
nb::capsule capsule_of(Export<M>* exported, const char* name) {
  exported->managed.manager = exported;
  exported->managed.deleter = [](M* managed) { delete static_cast<Export<M>*>(managed->manager); };
  // One that nobody took still has its name.
  PyObject* const capsule = PyCapsule_New(&exported->managed, name, [](PyObject* object) {
    const char* const name_now = PyCapsule_GetName(object);
    const std::string_view mine = std::is_same_v<M, dlpack::Managed> ? "dltensor" : "dltensor_versioned";
    if (name_now == nullptr || name_now != mine) return;
    auto* managed = static_cast<M*>(PyCapsule_GetPointer(object, name_now));
    managed->deleter(managed);
  });
  if (capsule == nullptr) {
    delete exported;
    throw nb::python_error();
  }
  return nb::steal<nb::capsule>(capsule);
}

template <class M>
std::unique_ptr<Export<M>> export_of(std::shared_ptr<DeviceMemory>&& memory, std::size_t offset,
                                     std::span<const std::int64_t> shape,
                                     std::span<const std::int64_t> strides, dlpack::DataType type) {
  auto exported = std::make_unique<Export<M>>();
  std::copy(shape.begin(), shape.end(), exported->shape.begin());
  std::copy(strides.begin(), strides.end(), exported->strides.begin());
  exported->managed.tensor = {.data = memory->data() == nullptr ? nullptr : memory->data() + offset,
                              .device = {dlpack::cuda, memory->device()},
                              .dimensions = static_cast<std::int32_t>(shape.size()),
                              .type = type,
                              .shape = exported->shape.data(),
                              .strides = exported->strides.data(),
                              .byte_offset = 0};
  exported->memory = std::move(memory);
  return exported;
}

}  // namespace

OnDevice::OnDevice(int device) {
  int now = device;
  // Where there is no device, the call itself says so.
  if (cudaGetDevice(&now) != cudaSuccess) {
    cudaGetLastError();
  } else if (now != device) {
    check(cudaSetDevice(device), "choosing device " + std::to_string(device));
    before_ = now;
  }
}
OnDevice::~OnDevice() {
  if (before_ >= 0) cudaSetDevice(before_);
}

int current_device() {
  int device = 0;
  if (cudaGetDevice(&device) == cudaSuccess) return device;
  cudaGetLastError();
  return 0;
}

DeviceMemory::DeviceMemory(int device, std::size_t bytes) : device_(device), bytes_(bytes) {
  if (bytes == 0) return;
  const OnDevice on(device);
  const DuringCaptures allowed;
  void* data = nullptr;
  check(cudaMalloc(&data, bytes), "taking memory of the device");
  data_ = static_cast<std::byte*>(data);
}
DeviceMemory::~DeviceMemory() {
  const DuringCaptures allowed;
  if (written_ != nullptr) cudaEventDestroy(written_);
  if (data_ != nullptr) cudaFree(data_);
}

void DeviceMemory::mark_written(Stream stream) {
  if (data_ == nullptr) return;
  cudaStreamCaptureStatus capture = cudaStreamCaptureStatusNone;
  check(cudaStreamIsCapturing(stream, &capture), "asking whether a stream is captured");
  is_marked_ = capture == cudaStreamCaptureStatusNone;
  if (!is_marked_) return;
  if (written_ == nullptr)
    check(cudaEventCreateWithFlags(&written_, cudaEventDisableTiming), "making an event");
  check(cudaEventRecord(written_, stream), "noting when answers are there");
}
void DeviceMemory::make_wait(Stream stream) const {
  if (!is_marked_) return;
  cudaStreamCaptureStatus capture = cudaStreamCaptureStatusNone;
  check(cudaStreamIsCapturing(stream, &capture), "asking whether a stream is captured");
  if (capture != cudaStreamCaptureStatusNone) return wait();  // a graph cannot wait for what is outside it
  check(cudaStreamWaitEvent(stream, written_, 0), "making a stream wait for answers");
}
void DeviceMemory::wait() const {
  const DuringCaptures allowed;
  if (is_marked_) check(cudaEventSynchronize(written_), "waiting for answers");
}
bool DeviceMemory::is_written() const {
  if (!is_marked_) return true;
  const DuringCaptures allowed;
  const cudaError_t result = cudaEventQuery(written_);
  if (result == cudaErrorNotReady) {
    cudaGetLastError();
    return false;
  }
  check(result, "waiting for answers");
  return true;
}

/// The entries of a `__cuda_array_interface__`, kept.
struct TakenArray::Interface {
  std::vector<std::int64_t> shape, strides;
  std::string typestr;
  cuda::CudaArrayInterface entries;
};

TakenArray::TakenArray(nb::handle object, std::string name, Stream stream) : name_(std::move(name)) {
  if (nb::hasattr(object, "__dlpack__") && nb::hasattr(object, "__dlpack_device__")) {
    take_tensor(object, stream);
  } else if (nb::hasattr(object, "__cuda_array_interface__")) {
    take_interface(object, stream);
  } else {
    const nb::str type(object.type().attr("__name__"));
    throw nb::type_error(
        (name_ + ": " + type.c_str() + " has neither __dlpack__ nor __cuda_array_interface__").c_str());
  }
}

void TakenArray::take_tensor(nb::handle object, Stream stream) {
  nb::object capsule;
  try {
    // An array of the host is refused before its library is asked for what it cannot do.
    const nb::object place = object.attr("__dlpack_device__")();
    const int type = nb::cast<int>(nb::int_(place[0]));
    if (type != dlpack::cuda && type != dlpack::cuda_managed)
      fail("it does not lie on a CUDA device (DLPack's device type " + std::to_string(type) + ")");
    const nb::object take = object.attr("__dlpack__");
    const nb::int_ number(number_of(stream));
    try {
      capsule = take(nb::arg("stream") = number, nb::arg("max_version") = nb::make_tuple(1, 0));
    } catch (const nb::python_error& error) {
      if (!error.matches(PyExc_TypeError)) throw;
      capsule = take(nb::arg("stream") = number);  // as before version 1 of DLPack
    }
  } catch (const nb::python_error& error) {
    fail("it cannot be taken (" + sentence_of(error) + ")");
  } catch (const nb::cast_error&) {
    fail("it does not say where it lies");
  }
  if (PyCapsule_IsValid(capsule.ptr(), "dltensor_versioned")) {
    tensor_ = owned<dlpack::Versioned>(capsule.ptr(), "dltensor_versioned", "used_dltensor_versioned");
  } else if (PyCapsule_IsValid(capsule.ptr(), "dltensor")) {
    tensor_ = owned<dlpack::Managed>(capsule.ptr(), "dltensor", "used_dltensor");
  } else {
    fail("its __dlpack__ gives no tensor");
  }
}

void TakenArray::take_interface(nb::handle object, Stream stream) {
  auto taken = std::make_shared<Interface>();
  cuda::CudaArrayInterface& entries = taken->entries;
  try {
    const nb::object given = object.attr("__cuda_array_interface__");
    const nb::object get = given.attr("get");
    for (const nb::handle extent : given["shape"]) taken->shape.push_back(nb::cast<std::int64_t>(extent));
    taken->typestr = nb::cast<nb::str>(given["typestr"]).c_str();
    const nb::object data = given["data"];
    entries.data = nb::cast<std::uintptr_t>(data[0]);
    entries.read_only = nb::cast<bool>(nb::bool_(data[1]));
    if (const nb::object strides = get("strides"); !strides.is_none()) {
      for (const nb::handle stride : strides) taken->strides.push_back(nb::cast<std::int64_t>(stride));
    }
    if (const nb::object on = get("stream"); !on.is_none()) entries.stream = nb::cast<std::uintptr_t>(on);
    entries.has_mask = !get("mask").is_none();
  } catch (const nb::python_error& error) {
    fail("its __cuda_array_interface__ cannot be read (" + sentence_of(error) + ")");
  } catch (const nb::cast_error&) {
    fail("its __cuda_array_interface__ has an entry of another type");
  }
  entries.shape = taken->shape;
  entries.strides = taken->strides;
  entries.typestr = taken->typestr;
  interface_ = taken;
  named([&] { return described(0); });  // before anything is asked of its stream
  if (!entries.stream || *entries.stream == number_of(stream)) return;
  cudaEvent_t written = nullptr;
  const std::string during = "waiting for the stream of the array " + name_;
  check(cudaEventCreateWithFlags(&written, cudaEventDisableTiming), during);
  cudaError_t result = cudaEventRecord(written, reinterpret_cast<Stream>(*entries.stream));
  if (result == cudaSuccess) result = cudaStreamWaitEvent(stream, written, 0);
  cudaEventDestroy(written);  // as soon as it has been waited for
  check(result, during);
}

cuda::ForeignArray TakenArray::described(int device) const {
  if (const auto* managed = std::get_if<cuda::OwnedTensor<dlpack::Managed>>(&tensor_))
    return {name_, **managed};
  if (const auto* versioned = std::get_if<cuda::OwnedTensor<dlpack::Versioned>>(&tensor_))
    return {name_, **versioned};
  return {name_, interface_->entries, device};
}

int TakenArray::device() const {
  if (const auto* managed = std::get_if<cuda::OwnedTensor<dlpack::Managed>>(&tensor_))
    return (**managed).tensor.device.id;
  if (const auto* versioned = std::get_if<cuda::OwnedTensor<dlpack::Versioned>>(&tensor_))
    return (**versioned).tensor.device.id;
  cudaPointerAttributes attributes{};
  const auto* data = reinterpret_cast<const void*>(interface_->entries.data);
  const bool is_known = data != nullptr && cudaPointerGetAttributes(&attributes, data) == cudaSuccess;
  cudaGetLastError();
  return is_known && attributes.type == cudaMemoryTypeDevice ? attributes.device : current_device();
}

// A tensor says where it lies. For the interface, CUDA is asked what is at its address.
void TakenArray::check_place(int device, const void* data) const {
  if (!interface_ || data == nullptr) return;
  cudaPointerAttributes attributes{};
  check(cudaPointerGetAttributes(&attributes, data), "asking where the array " + name_ + " lies");
  if (attributes.type == cudaMemoryTypeManaged) return;
  if (attributes.type != cudaMemoryTypeDevice) fail("there is no memory of a device at its address");
  if (attributes.device != device)
    fail("it lies on device " + std::to_string(attributes.device) + ", the hierarchy on device " +
         std::to_string(device));
}

nb::capsule to_capsule(std::shared_ptr<DeviceMemory> memory, std::size_t offset,
                       std::span<const std::int64_t> shape, std::span<const std::int64_t> strides,
                       dlpack::DataType type, bool versioned) {
  if (!versioned) {
    auto exported = export_of<dlpack::Managed>(std::move(memory), offset, shape, strides, type);
    return capsule_of(exported.release(), "dltensor");
  }
  auto exported = export_of<dlpack::Versioned>(std::move(memory), offset, shape, strides, type);
  exported->managed.major = 1;
  return capsule_of(exported.release(), "dltensor_versioned");
}

}  // namespace kerf::python
