#include "device.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "workbench/compare/binary_device.hpp"

#ifdef KERF_CUDA
#include "bindings/cuda/compare/cuda_device.hpp"
#endif

namespace kerf_tool {

std::unique_ptr<workbench::TracingDevice> open_device(const std::string& name) {
  if (name == "cpu") return nullptr;
  if (name == "binary") return workbench::open_binary_device();
  if (name != "cuda")
    throw CLI::ValidationError("--device",
                               fmt::format("there is no device {}; there are cpu, binary and cuda", name));
#ifdef KERF_CUDA
  return kerf::cuda::open_cuda_device();
#else
  throw CLI::ValidationError("--device", "this kerf was built without CUDA (KERF_BINDINGS_CUDA)");
#endif
}

}  // namespace kerf_tool
