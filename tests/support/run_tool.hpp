// Runs the command-line tool as a user would.
#pragma once

#include <cstdlib>
#include <string>

#include <sys/wait.h>

#include "tests/support/temporary_directory.hpp"

namespace kerf_tests {

struct Outcome {
  int status;          ///< exit status; -1 for a program that a signal ended
  std::string output;  ///< standard output
  std::string errors;  ///< standard error
};

/// `command` in a shell, its input empty.
inline Outcome run_command(const std::string& command) {
  const TemporaryDirectory directory;
  const std::string output = directory.file("output"), errors = directory.file("errors");
  const int status = std::system((command + " </dev/null >" + output + " 2>" + errors).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_bytes(output), read_bytes(errors)};
}

/// `kerf` with `arguments`, as one would type them in a shell.
inline Outcome run_tool(const std::string& arguments) {
  return run_command(KERF_TOOL " " + arguments);
}

}  // namespace kerf_tests
