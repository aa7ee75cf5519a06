// What shells complete after `kerf`, made from what the commands are defined to take.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "commands.hpp"
#include "definitions.hpp"
#include "output.hpp"
#include "workbench/generate/generated_scenes.hpp"

namespace kerf_tool {
namespace {

std::string replaced(std::string_view text, char from, std::string_view to) {
  std::string result;
  for (const char c : text) {
    if (c == from) {
      result += to;
    } else {
      result += c;
    }
  }
  return result;
}

std::string scene_names() {
  std::string names;
  for (const workbench::GeneratedScene& scene : workbench::generated_scenes())
    names += fmt::format("{}{}", names.empty() ? "" : " ", scene.name);
  return names;
}

bool is_named(const OptionDefinition& option) {
  return option.names.front().front() == '-';
}

std::string bash(const std::vector<CommandDefinition>& commands) {
  std::string names, after, options;
  for (const CommandDefinition& command : commands) {
    names += command.name + " ";
    std::string all = "--help", standing = "_kerf_files";
    for (const OptionDefinition& option : command.options) {
      const std::string words = fmt::format("_kerf_words '{}'", fmt::join(option.choices, " "));
      if (!is_named(option)) {
        if (option.kind == OptionDefinition::words) standing = words;
        continue;
      }
      std::string pattern;
      for (const std::string& name : option.names) {
        all += " " + name;
        pattern += fmt::format("{}{}:{}", pattern.empty() ? "" : " | ", command.name, name);
      }
      if (option.kind == OptionDefinition::flag) continue;
      const std::string found = option.kind == OptionDefinition::words       ? words
                                : option.kind == OptionDefinition::file      ? "_kerf_files"
                                : option.kind == OptionDefinition::directory ? "_kerf_folders"
                                                                             : ":";
      after += fmt::format("    {}) {}; return ;;\n", pattern, found);
    }
    const bool stands = command.takes_scenes || standing != "_kerf_files";
    options += fmt::format("    {}) options='{}'; {} ;;\n", command.name, all,
                           command.takes_scenes ? "scenes=1"
                           : stands             ? "standing=\"" + standing + "\""
                                                : ":");
  }
  return fmt::format(R"(# bash completion of kerf, written by: kerf completion bash
_kerf_words() {{ mapfile -t COMPREPLY < <(compgen -W "$1" -- "$current"); }}
_kerf_files() {{ mapfile -t COMPREPLY < <(compgen -f -- "$current"); }}
_kerf_folders() {{ mapfile -t COMPREPLY < <(compgen -d -- "$current"); }}
_kerf() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}}
  local command=${{COMP_WORDS[1]}} options='' scenes='' standing=''
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    _kerf_words '{}--help --version'
    return
  fi
  case $command:$previous in
{}  esac
  case $command in
{}  esac
  if [[ $current == -* ]]; then
    _kerf_words "$options"
  elif [ -n "$standing" ]; then
    eval "$standing"
  elif [ -n "$scenes" ]; then
    mapfile -t COMPREPLY < <(compgen -W '{}' -- "$current"; compgen -f -- "$current")
  fi
}}
complete -o filenames -F _kerf kerf
)",
                     names, after, options, scene_names());
}

// A description in single quotes of zsh's specifications, in which brackets and colons have a meaning.
std::string for_zsh(std::string_view text) {
  std::string safe = replaced(replaced(text, '\'', "'\\''"), '[', "\\[");
  return replaced(replaced(safe, ']', "\\]"), ':', "\\:");
}

std::string zsh(const std::vector<CommandDefinition>& commands) {
  std::string names, cases;
  for (const CommandDefinition& command : commands) {
    names += fmt::format("    '{}:{}'\n", command.name, for_zsh(command.description));
    cases += fmt::format("    {})\n      _arguments '--help[Print the options]'", command.name);
    for (const OptionDefinition& option : command.options) {
      const std::string values = option.kind == OptionDefinition::words
                                     ? fmt::format("({})", fmt::join(option.choices, " "))
                                 : option.kind == OptionDefinition::file      ? "_files"
                                 : option.kind == OptionDefinition::directory ? "_files -/"
                                 : option.kind == OptionDefinition::scene     ? "_kerf_scenes"
                                                                              : " ";
      if (!is_named(option)) {
        cases +=
            fmt::format(" \\\n        '{}:{}:{}'", option.repeated ? "*" : "1", option.names.front(), values);
        continue;
      }
      for (const std::string& name : option.names) {
        cases += fmt::format(" \\\n        '({}){}[{}]", fmt::join(option.names, " "), name,
                             for_zsh(option.description));
        if (option.kind != OptionDefinition::flag)
          cases += fmt::format(":{}:{}", for_zsh(option.value), values);
        cases += "'";
      }
    }
    cases += " ;;\n";
  }
  return fmt::format(R"(#compdef kerf
# zsh completion of kerf, written by: kerf completion zsh
_kerf_scenes() {{
  _alternative 'scenes:generated scene:({})' 'files:file:_files'
}}
_kerf() {{
  local -a commands
  commands=(
{}  )
  if (( CURRENT == 2 )); then
    _describe 'command' commands
    _arguments '--help[Print the commands]' '--version[Print the version]'
    return
  fi
  shift words
  (( CURRENT-- ))
  case $words[1] in
{}  esac
}}
if [ "$funcstack[1]" = _kerf ]; then
  _kerf "$@"
else
  compdef _kerf kerf
fi
)",
                     scene_names(), names, cases);
}

std::string for_fish(std::string_view text) {
  return replaced(replaced(text, '\\', "\\\\"), '\'', "\\'");
}

std::string fish(const std::vector<CommandDefinition>& commands) {
  std::string text =
      "# fish completion of kerf, written by: kerf completion fish\n"
      "complete -c kerf -f\n"
      "complete -c kerf -n __fish_use_subcommand -l help -d 'Print the commands'\n"
      "complete -c kerf -n __fish_use_subcommand -l version -d 'Print the version'\n";
  for (const CommandDefinition& command : commands) {
    text += fmt::format("complete -c kerf -n __fish_use_subcommand -a {} -d '{}'\n", command.name,
                        for_fish(command.description));
    const std::string in = fmt::format("complete -c kerf -n '__fish_seen_subcommand_from {}'", command.name);
    if (command.takes_scenes) text += fmt::format("{} -F -a '{}'\n", in, scene_names());
    text += fmt::format("{} -l help -d 'Print the options'\n", in);
    for (const OptionDefinition& option : command.options) {
      std::string line = in;
      if (!is_named(option)) {
        if (option.kind != OptionDefinition::words) continue;
        text += fmt::format("{} -a '{}'\n", in, fmt::join(option.choices, " "));
        continue;
      }
      for (const std::string& name : option.names)
        line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (option.kind == OptionDefinition::words) {
        line += fmt::format(" -x -a '{}'", fmt::join(option.choices, " "));
      } else if (option.kind == OptionDefinition::file) {
        line += " -r -F";
      } else if (option.kind == OptionDefinition::directory) {
        line += " -x -a '(__fish_complete_directories)'";
      } else if (option.kind != OptionDefinition::flag) {
        line += " -x";
      }
      text += fmt::format("{} -d '{}'\n", line, for_fish(option.description));
    }
  }
  return text;
}

}  // namespace

void add_completion_command(CLI::App& app) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("completion", "Write what a shell completes after kerf");
  command->add_option("SHELL", *shell, "Which shell")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->required();
  command->callback([shell, &app] {
    const auto commands = definitions(app);
    write_output(standard_output, *shell == "bash"  ? bash(commands)
                                  : *shell == "zsh" ? zsh(commands)
                                                    : fish(commands));
  });
}

}  // namespace kerf_tool
