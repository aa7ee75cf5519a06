#include "workbench/terminal/terminal.hpp"

#include <charconv>
#include <cstdlib>
#include <string_view>
#include <system_error>

#include <sys/ioctl.h>
#include <unistd.h>

namespace workbench {

bool obeys_escapes(std::FILE* stream) {
  const char* const term = std::getenv("TERM");
  const std::string_view name = term == nullptr ? "" : term;
  return isatty(fileno(stream)) == 1 && !name.empty() && name != "dumb";
}

std::size_t columns_of(std::FILE* stream) {
  constexpr std::size_t most = 1000;
  if (const char* const columns = std::getenv("COLUMNS")) {
    const std::string_view text = columns;
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc() && end == text.data() + text.size() && value > 0 && value <= most) return value;
  }
  winsize size{};
  if (ioctl(fileno(stream), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return default_columns;
  return size.ws_col;
}

Emphasis output_emphasis() {
  const char* const no_color = std::getenv("NO_COLOR");
  const bool plain = no_color != nullptr && *no_color != '\0';
  return obeys_escapes(stdout) && !plain ? Emphasis::bold : Emphasis::mark;
}

}  // namespace workbench
