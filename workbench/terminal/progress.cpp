#include "workbench/terminal/progress.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "workbench/terminal/terminal.hpp"

namespace workbench {
namespace {

constexpr std::size_t bar_width = 32;

}  // namespace

std::string draw_bar(double fraction, std::string_view what, std::size_t columns) {
  // Blocks of zero to seven eighths, for the end of the bar.
  static constexpr std::string_view eighths[] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  constexpr std::size_t percentage_width = 8;
  fraction = std::clamp(fraction, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(fraction * 8.0 * bar_width);
  std::string bar;
  for (std::size_t i = 0; i < filled / 8; ++i) bar += "█";
  bar += eighths[filled % 8];
  const std::size_t blanks = bar_width - filled / 8 - (filled % 8 != 0);
  const std::size_t room =
      columns > bar_width + percentage_width ? columns - bar_width - percentage_width : 0;
  return fmt::format("{}{} {:3.0f} %  {}", bar, std::string(blanks, ' '), 100.0 * fraction,
                     what.substr(0, room));
}

ProgressBar::ProgressBar(std::FILE* stream) : stream_(stream), terminal_(obeys_escapes(stream)) {}

ProgressBar::~ProgressBar() {
  clear();
}

void ProgressBar::show(double fraction, std::string_view what) {
  if (!terminal_) return;
  const std::lock_guard lock(mutex_);
  std::string line = draw_bar(fraction, what, columns_of(stream_) - 1);
  if (line == drawn_) return;
  fmt::print(stream_, "\r{}\033[K", line);
  std::fflush(stream_);
  drawn_ = std::move(line);
}

void ProgressBar::clear() {
  if (!terminal_) return;
  const std::lock_guard lock(mutex_);
  if (drawn_.empty()) return;
  fmt::print(stream_, "\r\033[K");
  std::fflush(stream_);
  drawn_.clear();
}

}  // namespace workbench
