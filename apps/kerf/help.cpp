#include "help.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "workbench/terminal/table.hpp"
#include "workbench/terminal/terminal.hpp"

namespace kerf_tool {
namespace {

class FoldingHelp : public CLI::Formatter {
 public:
  FoldingHelp() { column_width(names_width); }

  std::string make_description(const CLI::App* command) const override {
    return workbench::fold_text(command->get_description(), workbench::columns_of(stdout));
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    return folded(CLI::Formatter::make_option_desc(option));
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return workbench::beside_name("  " + command->get_name(), command->get_description(), names_width,
                                  workbench::columns_of(stdout));
  }

 private:
  static constexpr std::size_t names_width = 30;

  static std::string folded(const std::string& text) {
    const std::size_t columns =
        std::max(workbench::columns_of(stdout), names_width + workbench::min_text_width);
    std::string lines = workbench::fold_text(text, columns - names_width);
    lines.pop_back();
    return lines;
  }
};

}  // namespace

std::shared_ptr<CLI::Formatter> folding_help() {
  return std::make_shared<FoldingHelp>();
}

}  // namespace kerf_tool
