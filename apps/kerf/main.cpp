// kerf, the command-line tool. Exit status: 0; 1 with one line on standard error; 2 for bad usage.
#include <algorithm>
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
#include "help.hpp"
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

// Where no command is: the word that stands there is named, and the nearest command.
void check_command(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  if (argc < 2) throw CLI::ValidationError(fmt::format("a command is required: {}", fmt::join(names, ", ")));
  const std::string_view word = argv[1];
  if (word.empty() || word.front() == '-' || std::find(names.begin(), names.end(), word) != names.end())
    return;
  throw CLI::ValidationError(fmt::format(
      "there is no command '{}'{}{} the commands are {}", word, workbench::did_you_mean(word, names),
      workbench::did_you_mean(word, names).empty() ? ";" : "", fmt::join(names, ", ")));
}

// What is wrong with a command line, and the option that a word may have meant. CLI11 lists words that it did
// not expect from the last to the first.
std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) return error.what();
  std::vector<std::string> words = app.remaining(), names;
  for (const CLI::App* command : app.get_subcommands()) {
    for (const CLI::Option* option : command->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& word : command->remaining()) words.push_back(word);
  }
  std::string text = fmt::format("not expected: {}", fmt::join(words, " "));
  for (const std::string& word : words) {
    const std::string meant = workbench::did_you_mean(word, names);
    if (!meant.empty()) return text + meant;
  }
  return text;
}

int run(int argc, char** argv) {
  CLI::App app{"kerf: split bounding volume hierarchies over triangle meshes", "kerf"};
  app.set_version_flag("--version", "kerf " KERF_VERSION);
  app.require_subcommand(1);
  app.formatter(kerf_tool::folding_help());  // before commands, which take it over
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
    check_command(app, argc, argv);
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
    const std::string text = explain(app, error);
    fmt::print(stderr, "kerf: {}{} kerf --help says more\n", text, text.ends_with('?') ? "" : ";");
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
