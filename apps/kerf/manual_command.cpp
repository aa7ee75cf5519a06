// The manual page, made from what the commands are defined to take.
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <kerf/version.hpp>

#include "commands.hpp"
#include "definitions.hpp"
#include "output.hpp"
#include "workbench/generate/generated_scenes.hpp"

namespace kerf_tool {
namespace {

// Text in which roff finds nothing to obey: a hyphen is typed as one, and no line begins with a dot.
std::string escaped(std::string_view text) {
  std::string roff;
  for (const char c : text) {
    if (c == '\\') {
      roff += "\\e";
    } else if (c == '-') {
      roff += "\\-";
    } else {
      if (roff.empty() && (c == '.' || c == '\'')) roff += "\\&";
      roff += c;
    }
  }
  return roff;
}

std::string heading(const OptionDefinition& option) {
  std::string line;
  for (const std::string& name : option.names) {
    if (!line.empty()) line += ", ";
    line += fmt::format("\\f{}{}\\fR", option.names.front().front() == '-' ? 'B' : 'I', escaped(name));
  }
  if (!option.value.empty()) line += fmt::format(" \\fI{}\\fR", escaped(option.value));
  return line;
}

std::string synopsis(const CommandDefinition& command) {
  std::string line = fmt::format("\\fBkerf {}\\fR", command.name);
  bool options = false;
  for (const OptionDefinition& option : command.options) {
    if (option.names.front().front() != '-') {
      line += fmt::format(" \\fI{}\\fR{}", escaped(option.names.front()), option.repeated ? "..." : "");
    } else if (option.required) {
      line += fmt::format(" \\fB{}\\fR \\fI{}\\fR", escaped(option.names.front()), escaped(option.value));
    } else {
      options = true;
    }
  }
  return options ? line + " [\\fIOPTION\\fR...]" : line;
}

std::string section(const CommandDefinition& command) {
  std::string text = fmt::format(".SS {}\n{}.\n.PP\n{}\n", escaped(command.name),
                                 escaped(command.description), synopsis(command));
  for (const OptionDefinition& option : command.options) {
    text += fmt::format(".TP\n{}\n{}.\n", heading(option), escaped(option.description));
    if (option.kind == OptionDefinition::words && option.value.find('|') == std::string::npos) {
      std::string all;
      for (const std::string& choice : option.choices)
        all += fmt::format("{}\\fB{}\\fR", all.empty() ? "" : ", ", escaped(choice));
      text += fmt::format("One of {}.\n", all);
    }
    if (!option.preset.empty()) text += fmt::format("Default: \\fB{}\\fR.\n", escaped(option.preset));
  }
  return text;
}

std::string page(const CLI::App& app) {
  std::string text = fmt::format(
      ".TH KERF 1 \"\" \"kerf {}\" \"User Commands\"\n"
      ".SH NAME\nkerf \\- split bounding volume hierarchies over triangle meshes\n.SH SYNOPSIS\n",
      KERF_VERSION);
  const auto commands = definitions(app);
  for (const CommandDefinition& command : commands) text += synopsis(command) + "\n.br\n";
  text += "\\fBkerf\\fR [\\fICOMMAND\\fR] \\fB\\-\\-help\\fR\n.br\n\\fBkerf \\-\\-version\\fR\n";
  text +=
      ".SH DESCRIPTION\n"
      "Builds hierarchies (SBVH) over the triangles of scenes, compares the ways of building them, draws "
      "pictures, and saves hierarchies for programs that trace rays.\n"
      ".PP\n"
      "A \\fISCENE\\fR is a file (.obj .ply .stl .gltf .glb, gzipped or not, or .kerf) or the name of a "
      "generated scene, then optionally \\fB:rotate=\\fIDEGREES\\fB,detail=\\fIN\\fR.\nThe generated scenes "
      "are\n";
  std::string names;
  for (const workbench::GeneratedScene& scene : workbench::generated_scenes())
    names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", scene.name);
  text += names + ".\n.SH COMMANDS\n";
  for (const CommandDefinition& command : commands) text += section(command);
  text +=
      ".SH EXIT STATUS\n.TP\n0\nSuccess.\n.TP\n1\nFailure: one line on standard error names the file, the "
      "place "
      "in it and the cause.\n.TP\n2\nBad usage.\n"
      ".SH ENVIRONMENT\n.TP\n\\fBKERF_TARGET\\fR\nThe instruction set to use, in place of the best that the "
      "machine has.\n";
  return text;
}

}  // namespace

void add_manual_command(CLI::App& app) {
  app.add_subcommand("manual", "Write the manual page, for man -l -")->callback([&app] {
    write_output(standard_output, page(app));
  });
}

}  // namespace kerf_tool
