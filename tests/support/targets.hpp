// Tests that go over every instruction set of the machine.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "simd/dispatch.hpp"

namespace kerf_tests {

/// While it lives, KERF_TARGET has that value: what is built or loaded uses this instruction set.
class ChosenTarget {
 public:
  explicit ChosenTarget(const char* name) {
    if (const char* const before = std::getenv("KERF_TARGET")) before_ = before;
    setenv("KERF_TARGET", name, 1);
  }
  ~ChosenTarget() {
    if (before_) {
      setenv("KERF_TARGET", before_->c_str(), 1);
    } else {
      unsetenv("KERF_TARGET");
    }
  }
  ChosenTarget(const ChosenTarget&) = delete;
  ChosenTarget& operator=(const ChosenTarget&) = delete;

 private:
  std::optional<std::string> before_;
};

/// Calls `test(target)` for each instruction set of the machine, which is chosen meanwhile.
template <class Test>
void for_each_target(const Test& test) {
  for (const kerf::Target& target : kerf::supported_targets()) {
    SCOPED_TRACE(target.name);
    const ChosenTarget chosen(target.name);
    test(target);
    if (testing::Test::HasFatalFailure()) return;
  }
}

}  // namespace kerf_tests
