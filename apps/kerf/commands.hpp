// The subcommands. Each function adds one to the application, with its options and what it does when it is
// called.
//
// A command throws `CLI::ValidationError` for bad usage and `kerf::Error` for everything else; `main` reports
// both.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace kerf_tool {

void add_scenes_command(CLI::App& app);
void add_info_command(CLI::App& app);

/// `command_line` is what the user typed, for the report to show.
void add_compare_command(CLI::App& app, const std::string& command_line);
void add_sweep_command(CLI::App& app, const std::string& command_line);

void add_render_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_build_command(CLI::App& app);

/// Pages about the commands that have been added, and themselves.
void add_manual_command(CLI::App& app);
void add_completion_command(CLI::App& app);

}  // namespace kerf_tool
