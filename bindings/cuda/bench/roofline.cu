#include <algorithm>
#include <cfloat>
#include <cstdint>

#include "../src/device_array.hpp"
#include "roofline.hpp"

namespace kerf::cuda {
namespace {

constexpr int rounds = 512, chains = 8;

__global__ void multiply_add(float* out, float a, float b) {
  float x[chains];
  for (int i = 0; i < chains; ++i) x[i] = threadIdx.x + i;
  for (int r = 0; r < rounds; ++r)
    for (int i = 0; i < chains; ++i) x[i] = __fmaf_rn(x[i], a, b);
  float sum = 0;
  for (int i = 0; i < chains; ++i) sum += x[i];
  if (sum == 12345.678f) out[0] = sum;
}
__global__ void minimum(float* out, float a, float b) {
  float x[chains];
  for (int i = 0; i < chains; ++i) x[i] = threadIdx.x + i;
  for (int r = 0; r < rounds; ++r) {
    for (int i = 0; i < chains; ++i) x[i] = (r & 1) ? fminf(x[i], a) : fmaxf(x[i], b);
    a = __int_as_float(__float_as_int(a) + 1);
  }
  float sum = 0;
  for (int i = 0; i < chains; ++i) sum += x[i];
  if (sum == 12345.678f) out[0] = sum;
}
template <class Launch>
double best_milliseconds(Launch&& launch) {
  cudaEvent_t begin, end;
  check(cudaEventCreate(&begin), "making an event");
  check(cudaEventCreate(&end), "making an event");
  float best = FLT_MAX;
  for (int i = 0; i < 6; ++i) {
    check(cudaEventRecord(begin), "recording an event");
    launch();
    check(cudaEventRecord(end), "recording an event");
    check(cudaEventSynchronize(end), "waiting for the device");
    float ms = 0;
    check(cudaEventElapsedTime(&ms, begin, end), "reading a time");
    if (i > 0) best = std::min(best, ms);
  }
  cudaEventDestroy(begin);
  cudaEventDestroy(end);
  return best;
}

}  // namespace

Roofline measure_roofline() {
  Roofline result;
  int device = 0, multiprocessors = 0;
  check(cudaGetDevice(&device), "asking for the device");
  check(cudaDeviceGetAttribute(&multiprocessors, cudaDevAttrMultiProcessorCount, device),
        "asking for the device");
  const std::size_t bytes = std::size_t{4} << 30;
  DeviceArray<std::uint8_t> from(bytes), to(bytes);
  const double copy = best_milliseconds(
      [&] { check(cudaMemcpyAsync(to.data(), from.data(), bytes, cudaMemcpyDeviceToDevice), "copying"); });
  result.copy_gb_per_s = 2e-6 * static_cast<double>(bytes) / copy;
  const int blocks = multiprocessors * 16, threads = 256;
  const double operations = 1e-9 * static_cast<double>(blocks) * threads * rounds * chains;
  auto* out = reinterpret_cast<float*>(to.data());
  result.fma_tflops =
      2 * operations / best_milliseconds([&] { multiply_add<<<blocks, threads>>>(out, 0.999f, 0.5f); });
  result.minimum_tops =
      operations / best_milliseconds([&] { minimum<<<blocks, threads>>>(out, 3.0f, 2.0f); });
  check(cudaDeviceSynchronize(), "measuring the device");
  return result;
}

}  // namespace kerf::cuda
