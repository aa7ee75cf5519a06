// The CPU as a device that traces the builders' own binary trees, one node at a time, beside kerf's wide
// nodes.
#pragma once

#include <memory>

#include "workbench/compare/device.hpp"

namespace workbench {

/// Structures `binary` and `wide`. A binary tree is the setting of the figures in Stich et al. 2009; what a
/// builder gains there, wide nodes and vectors level out in part.
std::unique_ptr<TracingDevice> open_binary_device();

}  // namespace workbench
