// What the device can do at most: measured, not read from a data sheet.
#pragma once

namespace kerf::cuda {

struct Roofline {
  double copy_gb_per_s = 0;  ///< device memory to device memory, bytes read and bytes written
  double fma_tflops = 0;     ///< single precision, two operations each
  double minimum_tops = 0;   ///< minima of floats
};

Roofline measure_roofline();

}  // namespace kerf::cuda
