#include "workbench/report/machine.hpp"

#include <fstream>
#include <string_view>
#include <thread>

#include <fmt/format.h>
#include <sys/utsname.h>

namespace workbench {
namespace {

// What follows `key` and `separator` in the first line of `file` that has them. Empty if there is none.
std::string look_up(const char* file, std::string_view key, char separator) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (!line.starts_with(key)) continue;
    std::string value = line.substr(line.find(separator) + 1);
    value.erase(0, value.find_first_not_of(" \t\""));
    value.erase(value.find_last_not_of(" \t\"") + 1);
    return value;
  }
  return "";
}

std::string compiler() {
#if defined(__clang__)
  return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#elif defined(__GNUC__)
  return fmt::format("gcc {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
  return "unknown compiler";
#endif
}

}  // namespace

Machine this_machine() {
  utsname kernel{};
  uname(&kernel);
  std::string processor = look_up("/proc/cpuinfo", "model name", ':');
  if (processor.empty()) processor = kernel.machine;
  const std::string distribution = look_up("/etc/os-release", "PRETTY_NAME", '=');
  return {.processor = std::move(processor),
          .threads = std::thread::hardware_concurrency(),
          .system = fmt::format("{}, {} {}", distribution, kernel.sysname, kernel.release),
          .compiler = compiler()};
}

}  // namespace workbench
