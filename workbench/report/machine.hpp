// The machine on which measurements were made.
#pragma once

#include <string>

namespace workbench {

struct Machine {
  std::string processor;  ///< as the operating system calls it, with its family and model
  unsigned threads = 0;   ///< hardware threads that the operating system offers
  std::string system;     ///< the distribution and the kernel
  std::string compiler;   ///< that this program was compiled with
};

Machine this_machine();

/// How many of the machine's threads this process may run on: fewer under `taskset`, say.
unsigned usable_threads();

}  // namespace workbench
