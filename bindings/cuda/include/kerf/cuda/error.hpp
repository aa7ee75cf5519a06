// What is thrown where the device cannot do what it is asked.
#pragma once

#include <stdexcept>
#include <string>

namespace kerf::cuda {

class Error : public std::runtime_error {
 public:
  Error(const std::string& during, const std::string& reason)
      : std::runtime_error("CUDA: while " + during + ": " + reason) {}
  using std::runtime_error::runtime_error;
};

}  // namespace kerf::cuda
