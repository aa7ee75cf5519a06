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

/// How the best of a column stands out.
enum class Emphasis {
  bold,  ///< for terminals
  mark,  ///< a `*` behind it, for pipes and files
};

/// Heads and rows, each ending with a line break. Columns may differ in length; what is missing is blank.
std::string format(const std::vector<Column>& columns, Emphasis emphasis);

}  // namespace workbench
