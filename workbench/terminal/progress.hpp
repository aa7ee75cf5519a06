// A progress bar on the terminal for long work.
#pragma once

#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>

namespace workbench {

/// Draws on standard error if that is a terminal that obeys escapes, and does nothing otherwise. The
/// destructor removes the bar. Any thread may call `show`.
class ProgressBar {
 public:
  explicit ProgressBar(std::FILE* stream = stderr);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Shows the fraction that is done, in [0, 1], and a word for what is being done.
  void show(double fraction, std::string_view what);

  /// Removes the bar from the terminal, so that other lines can be written.
  void clear();

 private:
  std::FILE* stream_;
  bool terminal_;
  std::mutex mutex_;
  std::string drawn_;
};

/// One line of at most `columns` characters: the bar, the percentage and the word.
std::string draw_bar(double fraction, std::string_view what, std::size_t columns);

}  // namespace workbench
