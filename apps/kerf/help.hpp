// Help that fits the terminal.
#pragma once

#include <memory>

#include <CLI/CLI.hpp>

namespace kerf_tool {

/// Descriptions go on below where they began, instead of beyond the last column of the terminal.
std::shared_ptr<CLI::Formatter> folding_help();

}  // namespace kerf_tool
