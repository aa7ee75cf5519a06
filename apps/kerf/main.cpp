#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  CLI::App app{"kerf: split bounding volume hierarchies over triangle meshes", "kerf"};
  CLI11_PARSE(app, argc, argv);
}
