// Errors about what a user named: one line of the form "PLACE: what is wrong".
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <kerf/error.hpp>

namespace workbench {

/// `text` with control characters as programs spell them: whatever a file or its name holds, an error is one
/// line and moves no cursor.
inline std::string on_one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n')
      line += "\\n";
    else if (c == '\r')
      line += "\\r";
    else if (c == '\t')
      line += "\\t";
    else if (byte < 0x20 || byte == 0x7f)
      line += fmt::format("\\x{:02x}", byte);
    else
      line += c;
  }
  return line;
}

/// Throws a `kerf::Error` whose sentence begins with `place`, a file or what the user wrote to name a scene.
template <class... Values>
[[noreturn]] void raise(kerf::Error::Code code, const std::filesystem::path& place,
                        fmt::format_string<const Values&...> format, const Values&... values) {
  throw kerf::Error(code, on_one_line(place.string() + ": " + fmt::format(format, values...)));
}

}  // namespace workbench
