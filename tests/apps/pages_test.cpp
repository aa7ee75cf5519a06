// The manual page and the completions against the help of the commands, and in the shells themselves.
#include <algorithm>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/run_tool.hpp"

namespace {

using kerf_tests::Outcome;
using kerf_tests::run_command;
using kerf_tests::run_tool;
using kerf_tests::tool;

// All matches of the first group.
std::vector<std::string> found(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> all;
  for (auto at = std::sregex_iterator(text.begin(), text.end(), regex); at != std::sregex_iterator(); ++at)
    all.push_back((*at)[1]);
  return all;
}

std::vector<std::string> commands() {
  const std::string help = run_tool("--help").output;
  return found(help.substr(help.find("Subcommands:")), "\n  ([a-z]+) ");
}

// The options of a command, as its help has them: `--mode`, and the name without dashes.
std::set<std::string> options(const std::string& command) {
  std::set<std::string> names;
  const std::string help = run_tool(command + " --help").output;
  for (const std::string& name : found(help, "\n  (?:-.,)?--([a-z-]+)")) names.insert(name);
  names.erase("help");
  return names;
}

TEST(Pages, TheManualNamesEveryCommandAndOption) {
  const Outcome page = run_tool("manual");
  ASSERT_EQ(page.status, 0) << page.errors;
  const std::string text = std::regex_replace(page.output, std::regex(R"(\\-)"), "-");
  ASSERT_GE(commands().size(), 9u);
  for (const std::string& command : commands()) {
    const std::size_t begin = text.find(".SS " + command + "\n");
    ASSERT_NE(begin, std::string::npos) << command;
    const std::string section = text.substr(begin, text.find(".SS ", begin + 1) - begin);
    for (const std::string& option : options(command))
      EXPECT_NE(section.find("\\fB--" + option + "\\fR"), std::string::npos) << command << " --" << option;
  }
  EXPECT_EQ(std::count(page.output.begin(), page.output.end(), '\t'), 0);
}

TEST(Pages, CompletionsNameEveryCommandAndOption) {
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    const Outcome page = run_tool("completion " + shell);
    ASSERT_EQ(page.status, 0) << page.errors;
    for (const std::string& command : commands()) {
      EXPECT_NE(page.output.find(command), std::string::npos) << shell << ' ' << command;
      for (const std::string& option : options(command)) {
        const std::string written = shell == "fish" ? "-l " + option : "--" + option;
        EXPECT_NE(page.output.find(written), std::string::npos) << shell << ' ' << command << ' ' << option;
      }
    }
  }
  EXPECT_EQ(run_tool("completion tcsh").status, 2);
}

// What bash offers after a line, sorted.
std::string offered(const std::string& words) {
  const std::string script = "source <(" + tool() + " completion bash); COMP_WORDS=(" + words +
                             "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _kerf; "
                             "printf \"%s\\n\" \"${COMPREPLY[@]}\" | sort | tr \"\\n\" \" \"";
  return run_command("bash -c '" + script + "'").output;
}

TEST(Pages, BashCompletesCommandsOptionsAndValues) {
  EXPECT_EQ(offered("kerf re"), "render ");
  EXPECT_EQ(offered("kerf render --s"), "--scale --size ");
  EXPECT_EQ(offered("kerf render --mode \"\""), "ao shaded steps ");
  EXPECT_EQ(offered("kerf build --builder e"), "esc evh ");
  EXPECT_EQ(offered("kerf info --format gl"), "glb gltf ") << "choices in the order of the alphabet";
  EXPECT_EQ(offered("kerf completion \"\""), "bash fish zsh ");
  EXPECT_EQ(offered("kerf bench atr"), "atrium ");
  EXPECT_EQ(offered("kerf render atrium --size \"\""), " ") << "nobody knows which";
}

TEST(Pages, OtherShellsReadWhatIsWrittenForThem) {
  for (const std::string shell : {"zsh", "fish"}) {
    if (run_command("command -v " + shell).status != 0) continue;
    const Outcome read = run_command(tool() + " completion " + shell + " | " + shell + " -n /dev/stdin");
    EXPECT_EQ(read.status, 0) << read.errors;
  }
}

}  // namespace
