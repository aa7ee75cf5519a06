// Runs the command-line tool as a user would.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <sys/wait.h>

namespace kerf_test {

/// A directory of its own, gone at the end of the test.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string pattern = (std::filesystem::temp_directory_path() / "kerf-test-XXXXXX").string();
    if (mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline std::string read_file(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

inline void write_file(const std::string& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

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
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(output), read_file(errors)};
}

/// `kerf` with `arguments`, as one would type them in a shell.
inline Outcome run_tool(const std::string& arguments) {
  return run_command(KERF_TOOL " " + arguments);
}

}  // namespace kerf_test
