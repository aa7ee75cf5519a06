// The NVIDIA GPU on which `kerf compare --device cuda` traces.
#pragma once

#include <memory>

#include "workbench/compare/device.hpp"

namespace kerf::cuda {

/// The current device. Throws `Error` where there is none.
std::unique_ptr<workbench::TracingDevice> open_cuda_device();

}  // namespace kerf::cuda
