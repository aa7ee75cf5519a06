// What the tool's commands are defined to take, as pages and completions show it.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace kerf_tool {

/// An option of a command, or what stands for itself in its line.
struct OptionDefinition {
  enum Kind { flag, file, directory, scene, words, text };

  std::vector<std::string> names;  ///< "-o", "--output"; of what stands for itself, "SCENE"
  std::string value;               ///< "FILE"; empty for a flag
  std::string preset;              ///< what holds if it is not given; empty if nothing
  std::string description;
  std::vector<std::string> choices;  ///< of `words`: all values that there are
  Kind kind = text;
  bool required = false;
  bool repeated = false;
};

struct CommandDefinition {
  std::string name;
  std::string description;
  std::vector<OptionDefinition> options;  ///< without --help
  bool takes_scenes = false;
};

/// All commands of the application, in the order of its help.
std::vector<CommandDefinition> definitions(const CLI::App& app);

}  // namespace kerf_tool
