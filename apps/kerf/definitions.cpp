#include "definitions.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace kerf_tool {
namespace {

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

bool is_word(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '.';
  });
}

// "FORMAT:{obj,ply}" names all values, and so does "shaded|ao|steps"; of "y|z|X,Y,Z" the first two are words.
std::vector<std::string> choices_of(const std::string& type) {
  const std::size_t open = type.find('{'), close = type.rfind('}');
  const bool braces = open != std::string::npos && close != std::string::npos;
  std::vector<std::string> choices =
      braces ? split(std::string_view(type).substr(open + 1, close - open - 1), ',')
      : type.find('|') != std::string::npos ? split(type, '|')
                                            : std::vector<std::string>{};
  choices.erase(
      std::remove_if(choices.begin(), choices.end(), [](const auto& word) { return !is_word(word); }),
      choices.end());
  return choices;
}

OptionDefinition definition(const CLI::Option& option) {
  OptionDefinition made;
  const std::string type = option.get_type_name();
  made.description = option.get_description();
  made.required = option.get_required();
  made.preset = option.get_default_str();
  made.repeated = option.get_expected_max() > 1;
  made.choices = choices_of(type);
  if (option.get_positional()) {
    made.names = {"SCENE"};
    made.kind = OptionDefinition::scene;
    if (!made.choices.empty()) {
      made.names = {option.get_name()};
      made.kind = OptionDefinition::words;
    }
    return made;
  }
  for (const std::string& name : option.get_snames()) made.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) made.names.push_back("--" + name);
  if (option.get_items_expected_max() == 0) {
    made.kind = OptionDefinition::flag;
    return made;
  }
  made.value = type.substr(0, type.find(':'));
  if (!made.choices.empty()) {
    made.kind = OptionDefinition::words;
  } else if (made.value == "FILE") {
    made.kind = OptionDefinition::file;
  } else if (made.value == "DIRECTORY") {
    made.kind = OptionDefinition::directory;
  }
  return made;
}

}  // namespace

std::vector<CommandDefinition> definitions(const CLI::App& app) {
  std::vector<CommandDefinition> commands;
  for (const CLI::App* command : app.get_subcommands({})) {
    CommandDefinition made{command->get_name(), command->get_description(), {}, false};
    for (const CLI::Option* option : command->get_options()) {
      if (option == command->get_help_ptr()) continue;
      made.options.push_back(definition(*option));
      if (made.options.back().kind == OptionDefinition::scene) made.takes_scenes = true;
    }
    commands.push_back(std::move(made));
  }
  return commands;
}

}  // namespace kerf_tool
