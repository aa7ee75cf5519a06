// Tables for people, in a terminal or a pipe.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace workbench {

struct Cell {
  std::string text;
  bool best = false;  ///< of its column
};

struct Column {
  std::string head;
  std::vector<Cell> cells;
  bool left_aligned = false;
  std::string gap = "  ";  ///< before the column
};

/// How the best of a column is emphasised.
enum class Emphasis {
  bold,  ///< for terminals
  mark,  ///< a `*` after it, for pipes and files
};

/// What a terminal has that does not say.
inline constexpr std::size_t default_columns = 80;

/// The heads and the rows, each on a line that ends with a line break. Columns may differ in length; missing
/// cells are blank. What would be wider than `max_width` is folded: a last column of text at its blanks,
/// other columns into blocks below one another, each of which begins with the names of the rows. A column
/// without a head stays with the one before it.
std::string format(const std::vector<Column>& columns, Emphasis emphasis,
                   std::size_t max_width = default_columns);

/// `text` on lines of at most `max_width` characters, divided at its blanks, each ended with a line break.
std::string fold_text(const std::string& text, std::size_t max_width = default_columns);

}  // namespace workbench
