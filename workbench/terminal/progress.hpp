// A bar on the terminal while long work runs.
#pragma once

#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>

namespace workbench {

/// Draws on standard error if that is a terminal, and does nothing if it is not. The bar is gone when this
/// is. May be shown from any thread.
class ProgressBar {
 public:
  explicit ProgressBar(std::FILE* stream = stderr);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// The part that is done, in [0, 1], and a word for what is being done.
  void show(double part, std::string_view what);

  /// Takes the bar off the terminal, so that other lines can be written.
  void clear();

 private:
  std::FILE* stream_;
  bool terminal_;
  std::mutex mutex_;
  std::string drawn_;
};

/// One line of at most `columns` characters: the bar, the percentage and the word.
std::string draw_bar(double part, std::string_view what, std::size_t columns);

}  // namespace workbench
