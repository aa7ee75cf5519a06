// Hierarchies that are built here and traced elsewhere: what `compare` asks of a device.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <kerf/inspect.hpp>

#include "workbench/compare/trace.hpp"
#include "workbench/rays/rays.hpp"

namespace workbench {

/// A hierarchy in the memory of a device. Errors of the device are thrown as exceptions of `std::exception`.
class DeviceHierarchy {
 public:
  virtual ~DeviceHierarchy() = default;

  virtual std::size_t references() const = 0;
  virtual std::size_t nodes() const = 0;  ///< inner nodes
  virtual std::size_t bytes() const = 0;

  /// Traces the rays that were given last, counting as it goes.
  virtual CountedPass trace_counted() = 0;
  /// Traces them once more, without counting, and returns the seconds that this took on the device.
  virtual double time() = 0;
};

class TracingDevice {
 public:
  virtual ~TracingDevice() = default;

  virtual std::string name() const = 0;
  /// The forms in which the device can hold a tree; at least one.
  virtual std::vector<std::string> structures() const = 0;
  /// `tree` in the form with number `structure`. The device must outlive it.
  virtual std::unique_ptr<DeviceHierarchy> upload(const kerf::Tree& tree, std::size_t structure) = 0;
  /// Copies the rays that are traced from now on.
  virtual void set_rays(const RaySet& set) = 0;
};

}  // namespace workbench
