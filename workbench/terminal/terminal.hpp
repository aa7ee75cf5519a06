// What is known of the terminal that output goes to.
#pragma once

#include <cstddef>
#include <cstdio>

#include "workbench/terminal/table.hpp"

namespace workbench {

/// True if `stream` is a terminal that moves its cursor and changes its letters on request: TERM is set and
/// not `dumb`.
bool obeys_escapes(std::FILE* stream);

/// The columns of the terminal that `stream` is: COLUMNS if that is set, else what the terminal says,
/// else 80.
std::size_t columns_of(std::FILE* stream);

/// How the best of a column is emphasised on standard output. NO_COLOR (no-color.org) asks for none.
Emphasis output_emphasis();

}  // namespace workbench
