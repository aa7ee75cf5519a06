// Descriptions of arrays, right and wrong: no device is needed to read them.
#include <array>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/cuda/arrays.hpp>

namespace kerf::cuda {
namespace {

// A tensor of floats on device 0, row after row; `data` is never read.
struct TestTensor {
  std::vector<std::int64_t> shape, strides;
  dlpack::Tensor tensor{.data = reinterpret_cast<void*>(std::uintptr_t{0x1000}),
                        .device = {dlpack::cuda, 0},
                        .dimensions = 0,
                        .type = {dlpack::floating, 32, 1},
                        .shape = nullptr,
                        .strides = nullptr,
                        .byte_offset = 0};

  explicit TestTensor(std::vector<std::int64_t> given, std::vector<std::int64_t> given_strides = {})
      : shape(std::move(given)), strides(std::move(given_strides)) {
    tensor.shape = shape.data();
    tensor.dimensions = static_cast<std::int32_t>(shape.size());
    if (!strides.empty()) tensor.strides = strides.data();
  }
  TestTensor(const TestTensor&) = delete;

  TestTensor& of(dlpack::TypeCode code, int bits) {
    tensor.type = {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(bits), 1};
    return *this;
  }
};

// What reading says against it; empty if nothing.
template <class Read>
std::string complaint(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    const std::string text = error.what(), begin = "CUDA: while reading the array rays: ";
    EXPECT_EQ(text.substr(0, begin.size()), begin);
    return text.substr(begin.size());
  }
  return "";
}
template <class T>
std::string complaint(const dlpack::Tensor& tensor, int device = 0) {
  return complaint([&] { ForeignArray("rays", tensor).elements<T>(device); });
}

TEST(CudaArrays, TensorsOfEachElementAreReadWhereTheyLie) {
  TestTensor rays({5, 8});
  rays.tensor.byte_offset = 64;
  const std::span<const Ray> read = ForeignArray("rays", rays.tensor).elements<const Ray>(0);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(read.data()), 0x1040u);
  EXPECT_EQ(read.size(), 5u);
  EXPECT_EQ(complaint<Hit>(TestTensor({7, 5}).tensor), "");
  EXPECT_EQ(complaint<Hit>(TestTensor({7, 5}).of(dlpack::unsigned_integer, 32).tensor), "");
  EXPECT_EQ(complaint<SurfacePoint>(TestTensor({7, 8}).of(dlpack::signed_integer, 32).tensor), "");
  EXPECT_EQ(complaint<const Vec3f>(TestTensor({7, 3}).tensor), "");
  EXPECT_EQ(complaint<float>(TestTensor({7}).tensor), "");
  EXPECT_EQ(complaint<std::uint8_t>(TestTensor({7}).of(dlpack::boolean, 8).tensor), "");
  EXPECT_EQ(complaint<std::uint8_t>(TestTensor({7}).of(dlpack::unsigned_integer, 8).tensor), "");
  EXPECT_EQ(complaint<std::uint32_t>(TestTensor({7}).of(dlpack::signed_integer, 32).tensor), "");
  EXPECT_EQ(complaint<const std::uint64_t>(TestTensor({7}).of(dlpack::signed_integer, 64).tensor), "");
}

TEST(CudaArrays, AnotherTypeIsAnError) {
  EXPECT_EQ(complaint<const Ray>(TestTensor({5, 8}).of(dlpack::floating, 64).tensor),
            "it does not hold floats of 32 bits");
  EXPECT_EQ(complaint<const Ray>(TestTensor({5, 8}).of(dlpack::signed_integer, 32).tensor),
            "it does not hold floats of 32 bits");
  EXPECT_EQ(complaint<Hit>(TestTensor({5, 5}).of(dlpack::floating, 16).tensor),
            "it does not hold numbers of 32 bits");
  EXPECT_EQ(complaint<std::uint32_t>(TestTensor({5}).tensor), "it does not hold integers of 32 bits");
  EXPECT_EQ(complaint<std::uint8_t>(TestTensor({5}).of(dlpack::signed_integer, 64).tensor),
            "it does not hold integers of 8 bits");
  TestTensor lanes({5, 2});
  lanes.tensor.type.lanes = 4;
  EXPECT_EQ(complaint<const Ray>(lanes.tensor),
            "its type is neither an integer nor a float (DLPack's code 2, 32 bits, 4 lanes)");
  TestTensor brain({5, 8});
  brain.tensor.type = {4, 16, 1};
  EXPECT_EQ(complaint<const Ray>(brain.tensor),
            "its type is neither an integer nor a float (DLPack's code 4, 16 bits, 1 lanes)");
}

TEST(CudaArrays, AnotherShapeIsAnError) {
  EXPECT_EQ(complaint<const Ray>(TestTensor({5, 7}).tensor), "its shape is (5, 7), not (n, 8)");
  EXPECT_EQ(complaint<const Ray>(TestTensor({40}).tensor), "its shape is (40), not (n, 8)");
  EXPECT_EQ(complaint<const Ray>(TestTensor({}).tensor), "its shape is (), not (n, 8)");
  EXPECT_EQ(complaint<float>(TestTensor({5, 1}).tensor), "its shape is (5, 1), not (n)");
  EXPECT_EQ(complaint<const Ray>(TestTensor({-1, 8}).tensor), "its shape is (-1, 8)");
  EXPECT_EQ(complaint<const Ray>(TestTensor({std::int64_t{1} << 60, 8}).tensor),
            "it is too large: its shape is (1152921504606846976, 8)");
  TestTensor none({5, 8});
  none.tensor.shape = nullptr;
  EXPECT_EQ(complaint<const Ray>(none.tensor), "it has no shape");
}

TEST(CudaArrays, GapsBetweenElementsAreAnErrorExceptBetweenVertices) {
  const char* gaps = "its elements do not follow one another without gaps";
  EXPECT_EQ(complaint<const Ray>(TestTensor({5, 8}, {8, 1}).tensor), "");
  EXPECT_EQ(complaint<const Ray>(TestTensor({5, 8}, {9, 1}).tensor), gaps);
  EXPECT_EQ(complaint<const Ray>(TestTensor({5, 8}, {1, 5}).tensor), gaps);
  EXPECT_EQ(complaint<const Ray>(TestTensor({5, 8}, {0, 1}).tensor), gaps);
  EXPECT_EQ(complaint<float>(TestTensor({5}, {2}).tensor), gaps);
  // Of one element or none a stride says nothing.
  EXPECT_EQ(complaint<const Ray>(TestTensor({1, 8}, {100, 1}).tensor), "");
  EXPECT_EQ(complaint<const Ray>(TestTensor({0, 8}, {100, 7}).tensor), "");

  const TripleView<float> vertices = ForeignArray("v", TestTensor({5, 3}, {6, 1}).tensor).vertices(0);
  EXPECT_EQ(vertices.size(), 5u);
  EXPECT_EQ(vertices.stride(), 24u);
  const auto read_vertices = [](const TestTensor& tensor) {
    return complaint([&] { ForeignArray("rays", tensor.tensor).vertices(0); });
  };
  EXPECT_EQ(read_vertices(TestTensor({5, 3}, {3, 2})),
            "the numbers of a row do not follow one another without gaps");
  EXPECT_EQ(read_vertices(TestTensor({5, 3}, {2, 1})), "its rows lie 8 bytes apart");
  EXPECT_EQ(read_vertices(TestTensor({5, 3}, {-3, 1})), "its rows lie -12 bytes apart");
  EXPECT_EQ(read_vertices(TestTensor({5, 4})), "its shape is (5, 4), not (n, 3)");
  EXPECT_EQ(complaint([] {
              ForeignArray("rays", TestTensor({5, 3}).tensor).triangles(0);
            }),
            "it does not hold integers of 32 bits");
  EXPECT_EQ(ForeignArray("t", TestTensor({5, 3}).of(dlpack::signed_integer, 32).tensor).triangles(0).size(),
            5u);
}

TEST(CudaArrays, AnotherPlaceIsAnError) {
  TestTensor host({5, 8}), other({5, 8}), nowhere({5, 8}), odd({5, 8}), managed({5, 8});
  host.tensor.device.type = dlpack::cpu;
  EXPECT_EQ(complaint<const Ray>(host.tensor), "it does not lie on a CUDA device (DLPack's device type 1)");
  EXPECT_EQ(complaint<const Ray>(other.tensor, 1), "it lies on device 0, the hierarchy on device 1");
  nowhere.tensor.data = nullptr;
  EXPECT_EQ(complaint<const Ray>(nowhere.tensor), "it has no address");
  odd.tensor.byte_offset = 2;
  EXPECT_EQ(complaint<const Ray>(odd.tensor), "its address is not a multiple of 4");
  managed.tensor.device.type = dlpack::cuda_managed;
  EXPECT_EQ(complaint<const Ray>(managed.tensor), "");
  TestTensor empty({0, 8});
  empty.tensor.data = nullptr;
  EXPECT_EQ(complaint<const Ray>(empty.tensor), "");
}

TEST(CudaArrays, VersionsAndReadOnlyTensorsAreHeeded) {
  TestTensor tensor({5, 5});
  dlpack::Versioned versioned{1, 1, nullptr, nullptr, dlpack::read_only_flag, tensor.tensor};
  EXPECT_EQ(ForeignArray("hits", versioned).elements<const Hit>(0).size(), 5u);
  EXPECT_EQ(complaint([&] { ForeignArray("rays", versioned).elements<Hit>(0); }), "it can only be read");
  versioned.major = 2;
  EXPECT_EQ(complaint([&] { ForeignArray("rays", versioned); }), "it is of version 2 of DLPack, not 1");
}

TEST(CudaArrays, OwnedTensorsAreDeletedOnce) {
  static int deleted = 0;
  TestTensor tensor({5, 8});
  dlpack::Managed managed{tensor.tensor, nullptr, [](dlpack::Managed*) { ++deleted; }};
  {
    OwnedTensor<dlpack::Managed> owned(&managed);
    OwnedTensor<dlpack::Managed> moved(std::move(owned));
    EXPECT_EQ(ForeignArray("rays", *moved).elements<const Ray>(0).size(), 5u);
    EXPECT_EQ(deleted, 0);
  }
  EXPECT_EQ(deleted, 1);
}

TEST(CudaArrays, InterfacesAreReadAsTensorsAre) {
  const std::array<std::int64_t, 2> shape{5, 8}, strides{32, 4}, columns{4, 20};
  const CudaArrayInterface right{.shape = shape, .typestr = "<f4", .data = 0x1000};
  const auto read = [](const CudaArrayInterface& interface, int device = 0) {
    return complaint([&] { ForeignArray("rays", interface, device).elements<Ray>(0); });
  };
  const auto with = [&](auto&& change) {
    CudaArrayInterface interface = right;
    change(interface);
    return interface;
  };
  const std::span<Ray> rays = ForeignArray("rays", right, 0).elements<Ray>(0);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(rays.data()), 0x1000u);
  EXPECT_EQ(rays.size(), 5u);
  EXPECT_EQ(read(with([&](auto& a) { a.strides = strides; })), "");
  EXPECT_EQ(read(with([&](auto& a) { a.stream = 1; })), "");
  EXPECT_EQ(read(with([&](auto& a) { a.strides = columns; })),
            "its elements do not follow one another without gaps");
  EXPECT_EQ(read(with([&](auto& a) { a.strides = std::span(strides).first(1); })),
            "it has 2 dimensions and 1 strides");
  EXPECT_EQ(read(with([&](auto& a) { a.read_only = true; })), "it can only be read");
  EXPECT_EQ(read(with([&](auto& a) { a.has_mask = true; })), "it has a mask");
  EXPECT_EQ(read(with([&](auto& a) { a.stream = 0; })), "its stream is 0, which may be any of two");
  EXPECT_EQ(read(with([&](auto& a) { a.data = 0; })), "it has no address");
  EXPECT_EQ(read(right, 1), "it lies on device 1, the hierarchy on device 0");
  for (const char* type : {">f4", "f4", "<c8", "<f", "|f4", "=f4", "<f16", ""}) {
    EXPECT_EQ(read(with([&](auto& a) { a.typestr = type; })),
              "its type is neither an integer nor a float in the device's order of bytes (\"" +
                  std::string(type) + "\")");
  }
  EXPECT_EQ(read(with([&](auto& a) { a.typestr = "<f8"; })), "it does not hold floats of 32 bits");
  const std::array<std::int64_t, 1> flat{7};
  const CudaArrayInterface bools{.shape = flat, .typestr = "|b1", .data = 0x1001};
  EXPECT_EQ(ForeignArray("b", bools, 0).elements<std::uint8_t>(0).size(), 7u);
}

}  // namespace
}  // namespace kerf::cuda
