// Runs the command-line tool as a user would.
#pragma once

#include <string>

namespace kerf_tests {

struct Outcome {
  int status;          ///< exit status; -1 for a program that a signal ended
  std::string output;  ///< standard output
  std::string errors;  ///< standard error
};

/// `command` in a shell, its input empty.
Outcome run_command(const std::string& command);

/// The tool as a word for a command.
std::string tool();

/// `kerf` with `arguments`, as one would type them in a shell.
Outcome run_tool(const std::string& arguments);

}  // namespace kerf_tests
