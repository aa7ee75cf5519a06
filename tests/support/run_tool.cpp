#include "support/run_tool.hpp"

#include <cstdlib>

#include <sys/wait.h>

#include "support/temporary_directory.hpp"

namespace kerf_tests {

Outcome run_command(const std::string& command) {
  const TemporaryDirectory directory;
  const std::string output = directory.file("output"), errors = directory.file("errors");
  const int status = std::system((command + " </dev/null >" + output + " 2>" + errors).c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_bytes(output), read_bytes(errors)};
}

std::string tool() {
  return "'" KERF_TOOL "'";
}

Outcome run_tool(const std::string& arguments) {
  return run_command(tool() + " " + arguments);
}

}  // namespace kerf_tests
