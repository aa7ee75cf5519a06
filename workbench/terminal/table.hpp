// Tables for people, in a terminal or a pipe.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
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

/// 1234567 as `1,234,567`.
std::string format_count(std::size_t count);

/// `1,234,567 triangles` or `1 triangle`, of `one` "triangle" and `many` "triangles".
std::string format_count(std::size_t count, std::string_view one, std::string_view many);

/// `text` on lines of at most `max_width` characters, divided at its blanks, each ended with a line break.
std::string fold_text(const std::string& text, std::size_t max_width = default_columns);

/// Narrower text is hard to read.
inline constexpr std::size_t min_text_width = 24;

/// `name`, and `text` beside it from column `begin` on, folded: it goes on below where it began, and is at
/// least `min_text_width` wide.
std::string beside_name(std::string_view name, const std::string& text, std::size_t begin,
                        std::size_t max_width);

}  // namespace workbench
