// Errors about what a user named: one line of the form "PLACE: what is wrong".
#pragma once

#include <filesystem>

#include <fmt/format.h>
#include <kerf/error.hpp>

namespace workbench {

/// Throws a `kerf::Error` whose sentence begins with `place`, a file or what the user wrote to name a scene.
template <class... Values>
[[noreturn]] void raise(kerf::Error::Code code, const std::filesystem::path& place,
                        fmt::format_string<const Values&...> format, const Values&... values) {
  throw kerf::Error(code, place.string() + ": " + fmt::format(format, values...));
}

}  // namespace workbench
