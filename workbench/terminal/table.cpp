#include "workbench/terminal/table.hpp"

#include <algorithm>
#include <cstddef>

namespace workbench {
namespace {

// The number of characters of UTF-8 text: bytes that do not continue a character.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char byte) {
    return (static_cast<unsigned char>(byte) & 0xc0u) != 0x80u;
  }));
}

std::string trim_end(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

}  // namespace

std::string format(const std::vector<Column>& columns, Emphasis emphasis) {
  std::vector<std::size_t> widths;
  std::vector<bool> marked;  // columns in which rows without the mark have a blank instead
  std::size_t rows = 0;
  for (const Column& column : columns) {
    std::size_t widest = width(column.head);
    bool any_best = false;
    for (const Cell& cell : column.cells) {
      widest = std::max(widest, width(cell.text));
      any_best |= cell.best;
    }
    widths.push_back(widest);
    marked.push_back(any_best && emphasis == Emphasis::mark);
    rows = std::max(rows, column.cells.size());
  }

  std::string text;
  for (std::size_t row = 0; row <= rows; ++row) {  // row 0 holds the heads
    std::string line;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const Column& column = columns[c];
      Cell cell;
      if (row == 0)
        cell.text = column.head;
      else if (row <= column.cells.size())
        cell = column.cells[row - 1];
      const std::string blank(widths[c] - width(cell.text), ' ');
      line += column.gap;
      if (!column.left_aligned) line += blank;
      const bool bold = cell.best && emphasis == Emphasis::bold;
      if (bold) line += "\033[1m";
      line += cell.text;
      if (bold) line += "\033[0m";
      if (column.left_aligned) line += blank;
      if (marked[c]) line += cell.best ? "*" : " ";
    }
    text += trim_end(std::move(line));
  }
  return text;
}

}  // namespace workbench
