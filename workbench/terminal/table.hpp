// Tables for people, in a terminal or a pipe.
#pragma once

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

/// The heads and the rows, each on a line that ends with a line break. Columns may differ in length; missing
/// cells are blank.
std::string format(const std::vector<Column>& columns, Emphasis emphasis);

}  // namespace workbench
