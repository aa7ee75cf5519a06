#include "workbench/terminal/table.hpp"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

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

// The width of a column with its gap and its mark.
std::size_t full_width(const Column& column, Emphasis emphasis) {
  std::size_t widest = width(column.head);
  bool any_best = false;
  for (const Cell& cell : column.cells) {
    widest = std::max(widest, width(cell.text));
    any_best |= cell.best;
  }
  return column.gap.size() + widest + (any_best && emphasis == Emphasis::mark);
}

std::size_t full_width(const std::vector<Column>& columns, Emphasis emphasis) {
  std::size_t sum = 0;
  for (const Column& column : columns) sum += full_width(column, emphasis);
  return sum;
}

// Lines of at most `room` characters, divided at blanks.
std::vector<std::string> wrap(const std::string& text, std::size_t room) {
  std::vector<std::string> lines(1);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    if (!lines.back().empty() && width(lines.back()) + 1 + width(word) > room) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
    begin = end + 1;
  }
  return lines;
}

// The same table with the text of its last column on several lines.
std::vector<Column> with_last_wrapped(const std::vector<Column>& columns, std::size_t room) {
  std::vector<Column> result = columns;
  for (Column& column : result) column.cells.clear();
  const std::size_t last = columns.size() - 1;
  for (std::size_t row = 0; row < columns[last].cells.size(); ++row) {
    const std::vector<std::string> lines = wrap(columns[last].cells[row].text, room);
    for (std::size_t line = 0; line < lines.size(); ++line) {
      for (std::size_t c = 0; c < last; ++c) {
        const bool filled = line == 0 && row < columns[c].cells.size();
        result[c].cells.push_back(filled ? columns[c].cells[row] : Cell{});
      }
      result[last].cells.push_back({lines[line]});
    }
  }
  return result;
}

// Blocks that are no wider than `max_width`, if their columns allow it.
std::vector<std::vector<Column>> fold(const std::vector<Column>& columns, Emphasis emphasis,
                                      std::size_t max_width) {
  // All left-aligned columns at the beginning name the rows; where these alone are half as wide, the first.
  std::size_t names = 0;
  while (names < columns.size() && columns[names].left_aligned) ++names;
  const auto first = columns.begin();
  const auto behind = [&](std::size_t n) { return first + static_cast<std::ptrdiff_t>(n); };
  std::vector<Column> lead(first, behind(names));
  if (full_width(lead, emphasis) > max_width / 2) lead.assign(first, behind(1));

  std::vector<std::vector<Column>> blocks{std::vector<Column>(first, behind(names))};
  for (std::size_t begin = names; begin < columns.size();) {
    std::size_t end = begin + 1;
    while (end < columns.size() && columns[end].head.empty()) ++end;
    const std::vector<Column> together(behind(begin), behind(end));
    const std::size_t taken = full_width(blocks.back(), emphasis);
    if (taken + full_width(together, emphasis) > max_width && begin > names) blocks.push_back(lead);
    blocks.back().insert(blocks.back().end(), together.begin(), together.end());
    begin = end;
  }
  return blocks;
}

std::string format_block(const std::vector<Column>& columns, Emphasis emphasis) {
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

}  // namespace

std::string format(const std::vector<Column>& columns, Emphasis emphasis, std::size_t max_width) {
  if (columns.size() < 2 || full_width(columns, emphasis) <= max_width)
    return format_block(columns, emphasis);
  constexpr std::size_t min_room = 24;  // narrower text is hard to read
  const std::vector<Column> rest(columns.begin(), columns.end() - 1);
  const std::size_t taken = full_width(rest, emphasis) + columns.back().gap.size();
  if (columns.back().left_aligned && taken + min_room <= max_width)
    return format_block(with_last_wrapped(columns, max_width - taken), emphasis);
  std::string text;
  for (const std::vector<Column>& block : fold(columns, emphasis, max_width)) {
    if (!text.empty()) text += "\n";
    text += format_block(block, emphasis);
  }
  return text;
}

std::string format_count(std::size_t count) {
  if (count < 1000) return fmt::format("{}", count);
  return fmt::format("{},{:03}", format_count(count / 1000), count % 1000);
}

std::string format_count(std::size_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", format_count(count), count == 1 ? one : many);
}

std::string fold_text(const std::string& text, std::size_t max_width) {
  std::string folded;
  for (const std::string& line : wrap(text, max_width)) folded += line + "\n";
  return folded;
}

std::string beside_name(std::string_view name, const std::string& text, std::size_t begin,
                        std::size_t max_width) {
  std::string lines(name);
  lines.resize(std::max(lines.size() + 1, begin), ' ');
  const std::string folded = fold_text(text, std::max(max_width, begin + min_text_width) - begin);
  for (std::size_t i = 0; i < folded.size(); ++i) {
    lines += folded[i];
    if (folded[i] == '\n' && i + 1 < folded.size()) lines.append(begin, ' ');
  }
  return lines;
}

}  // namespace workbench
