// Which device traces in `kerf compare`.
#pragma once

#include <memory>
#include <string>

#include "workbench/compare/device.hpp"

namespace kerf_tool {

/// The device with this name: none for `cpu`. Throws `CLI::ValidationError` for a name that this program does
/// not know, or knows only where it is built with bindings/cuda, and what the device throws if it cannot be
/// used.
std::unique_ptr<workbench::TracingDevice> open_device(const std::string& name);

}  // namespace kerf_tool
