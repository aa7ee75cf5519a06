#include "simd/dispatch.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "base/raise.hpp"
#include "simd/targets.hpp"

namespace kerf {
namespace {

constexpr bool one_target_only = (HWY_TARGETS & (HWY_TARGETS - 1)) == 0;

// All dispatch tables have one shape, since all files of kernels include simd/targets.hpp. Where one target
// alone is compiled, tables have one entry.
std::size_t table_index([[maybe_unused]] std::int64_t target) {
  if constexpr (one_target_only) {
    return 0;
  } else {
    hwy::ChosenTarget chosen;
    chosen.Update(target);
    return chosen.GetIndex();
  }
}

struct TargetList {
  std::array<Target, 64> targets;
  std::size_t count = 0;

  TargetList() {
    // The compiler itself uses the static target, so that the machine has it, whatever Highway says: it does
    // not report NEON where AES is missing, which kernels do not use. Where there is no other, as in
    // WebAssembly, Highway need not be asked, and nothing of its library is linked.
    std::int64_t rest = HWY_STATIC_TARGET;
    if constexpr (!one_target_only) rest = (hwy::SupportedTargets() | rest) & HWY_TARGETS;
    for (; rest != 0; rest &= rest - 1) {
      const std::int64_t best = rest & -rest;
      targets[count++] = {hwy::TargetName(best), table_index(best)};
    }
  }
};

[[noreturn]] void refuse(const char* wanted) {
  char names[256] = "";
  std::size_t length = 0;
  for (const Target& target : supported_targets()) {
    const int written =
        std::snprintf(names + length, sizeof(names) - length, "%s%s", length ? ", " : "", target.name);
    length = std::min(sizeof(names) - 1, length + static_cast<std::size_t>(written));
  }
  raise(Error::invalid_argument, "KERF_TARGET is \"%.40s\", of which this machine knows nothing; it has %s",
        wanted, names);
}

}  // namespace

std::span<const Target> supported_targets() {
  static const TargetList list;
  return std::span(list.targets).first(list.count);
}

Target choose_target() {
  const std::span<const Target> targets = supported_targets();
  const char* const wanted = std::getenv("KERF_TARGET");
  if (wanted != nullptr && *wanted != '\0') {
    const auto found = std::find_if(targets.begin(), targets.end(), [wanted](const Target& target) {
      return target.name == std::string_view(wanted);
    });
    if (found == targets.end()) refuse(wanted);
    return *found;
  }
  return targets.front();
}

}  // namespace kerf
