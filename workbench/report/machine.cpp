#include "workbench/report/machine.hpp"

#include <algorithm>
#include <fstream>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <sched.h>
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

// The design of a processor of AMD (AMD's "Revision Guide" of each family). Clouds name processors by their
// brand alone.
std::string_view design(unsigned family, unsigned model) {
  if (family == 0x17) return model < 0x30 ? "Zen" : "Zen 2";
  if (family == 0x19) return (model >= 0x10 && model < 0x20) || model >= 0x60 ? "Zen 4" : "Zen 3";
  return family == 0x1a ? "Zen 5" : "";
}

// "AMD EPYC 7B13 (Zen 3: family 25, model 1)".
std::string processor() {
  constexpr const char* file = "/proc/cpuinfo";
  const std::string name = look_up(file, "model name", ':');
  const std::string family = look_up(file, "cpu family", ':'), model = look_up(file, "model\t", ':');
  if (name.empty() || family.empty() || model.empty()) return name;
  const std::string_view known =
      look_up(file, "vendor_id", ':') == "AuthenticAMD"
          ? design(static_cast<unsigned>(std::stoul(family)), static_cast<unsigned>(std::stoul(model)))
          : "";
  return fmt::format("{} ({}{}family {}, model {})", name, known, known.empty() ? "" : ": ", family, model);
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
  std::string name = processor();
  if (name.empty()) name = kernel.machine;
  const std::string distribution = look_up("/etc/os-release", "PRETTY_NAME", '=');
  return {.processor = std::move(name),
          .threads = std::thread::hardware_concurrency(),
          .system = fmt::format("{}, {} {}", distribution, kernel.sysname, kernel.release),
          .compiler = compiler()};
}

unsigned usable_threads() {
#ifdef __linux__
  cpu_set_t usable;
  if (sched_getaffinity(0, sizeof usable, &usable) == 0) return static_cast<unsigned>(CPU_COUNT(&usable));
#endif
  return std::max(1u, std::thread::hardware_concurrency());
}

}  // namespace workbench
