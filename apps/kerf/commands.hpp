// The subcommands. Each adds itself to the application, with what it does when it is called.
//
// A command throws `CLI::ValidationError` for bad usage and `kerf::Error` for all else; `main` reports both.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace kerf_tool {

void add_scenes_command(CLI::App& app);
void add_info_command(CLI::App& app);
/// `command_line` is what the user typed; the report shows it.
void add_compare_command(CLI::App& app, const std::string& command_line);
void add_sweep_command(CLI::App& app, const std::string& command_line);
void add_render_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_build_command(CLI::App& app);

}  // namespace kerf_tool
