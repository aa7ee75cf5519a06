// kerf, the command-line tool. Exit status: 0; 1 with one line on standard error; 2 for bad usage.
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <kerf/error.hpp>
#include <kerf/version.hpp>

#include "commands.hpp"
#include "workbench/base/nearest_word.hpp"

namespace {

constexpr int failure = 1;
constexpr int bad_usage = 2;

// An argument in the form in which a shell reads it.
std::string quote(const std::string& argument) {
  const bool plain = argument.find_first_not_of(
                         "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                         "_-./,:=+@%") == std::string::npos;
  if (plain && !argument.empty()) return argument;
  std::string quoted = "'";
  for (const char c : argument) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string join(int argc, char** argv) {
  std::string line = "kerf";
  for (int i = 1; i < argc; ++i) line += fmt::format(" {}", quote(argv[i]));
  return line;
}

// A word where a command must be: it is named, and the nearest command.
void check_command(const CLI::App& app, std::string_view word) {
  if (word.empty() || word.front() == '-') return;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) {
    if (command->get_name() == word) return;
    names.push_back(command->get_name());
  }
  throw CLI::ValidationError(fmt::format(
      "there is no command '{}'{}{} the commands are {}", word, workbench::did_you_mean(word, names),
      workbench::did_you_mean(word, names).empty() ? ";" : "", fmt::join(names, ", ")));
}

int run(int argc, char** argv) {
  CLI::App app{"kerf: split bounding volume hierarchies over triangle meshes", "kerf"};
  app.set_version_flag("--version", "kerf " KERF_VERSION);
  app.require_subcommand(1);
  kerf_tool::add_scenes_command(app);
  kerf_tool::add_info_command(app);
  kerf_tool::add_compare_command(app, join(argc, argv));
  kerf_tool::add_sweep_command(app, join(argc, argv));
  kerf_tool::add_render_command(app);
  kerf_tool::add_bench_command(app);
  kerf_tool::add_build_command(app);
  kerf_tool::add_manual_command(app);
  kerf_tool::add_completion_command(app);
  try {
    if (argc > 1) check_command(app, argv[1]);
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
    fmt::print(stderr, "kerf: {}; kerf --help says more\n", error.what());
    return bad_usage;
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const kerf::Error& error) {
    fmt::print(stderr, "kerf: {}\n", error.what());
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "kerf: not enough memory\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "kerf: {}\n", error.what());
  }
  return failure;
}
