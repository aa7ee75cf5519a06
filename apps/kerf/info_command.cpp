#include <memory>
#include <set>

#include <fmt/format.h>
#include <kerf/inspect.hpp>

#include "arguments.hpp"
#include "commands.hpp"
#include "output.hpp"
#include "workbench/compare/measures.hpp"

namespace kerf_tool {
namespace {

using namespace workbench;

struct Options {
  std::string scene;
  std::string builder = "sbvh";
};

std::string line(std::string_view name, std::string_view value) {
  return fmt::format("  {:<22}{}\n", name, value);
}

std::string format_point(const kerf::Vec3f& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

std::string format_leaf_sizes(const std::vector<std::size_t>& leaf_sizes) {
  std::string text;
  for (std::size_t size = 0; size < leaf_sizes.size(); ++size) {
    if (leaf_sizes[size] == 0) continue;
    text += fmt::format("{}{} with {}", text.empty() ? "" : ", ", format_count(leaf_sizes[size]), size);
  }
  return text.empty() ? "none" : text;
}

std::string describe(const Scene& scene, const kerf::BuilderInfo& builder) {
  const kerf::TriangleMesh mesh = scene.mesh();
  const kerf::Tree tree = kerf::build_tree(mesh, {.builder = builder.builder});
  const kerf::TreeCounts counts = count_tree(tree);
  const double sah = surface_area_cost(tree);
  const double epo = end_point_overlap(tree);
  const double lcv = leaf_count_variability(tree);
  const auto references = tree.references();
  const std::size_t distinct = std::set<std::uint32_t>(references.begin(), references.end()).size();
  const kerf::Bvh bvh = kerf::make_bvh(tree);
  const kerf::Box3f bounds = bvh.bounds();

  std::string text = scene.name + "\n";
  text += line("vertices", format_count(scene.vertices.size()));
  text += line("triangles", format_count(tree.triangles()));
  text += line("degenerate", format_count(bvh.statistics().degenerate_triangles));
  if (const std::size_t flattened = scene.contents.flattened_triangles)
    text += line("flattened", format_count(flattened) + " triangles, by rounding to floats");
  text += line("bounds", bounds.empty() ? "empty"
                                        : fmt::format("{} to {}", format_point(bounds.lower),
                                                      format_point(bounds.upper)));
  text += line("viewpoints", format_count(scene.viewpoints.size()));
  if (!scene.contents.entries.empty()) text += "\nbeside triangles\n";
  for (const auto& [name, value] : scene.contents.entries) text += line(name, value);
  text += fmt::format("\n{} tree\n", builder.name);
  text += line("nodes", format_count(counts.nodes));
  text += line("leaves", format_count(counts.leaves));
  text += line("depth", format_count(counts.depth));
  text += line("leaf sizes", format_leaf_sizes(counts.leaf_sizes));
  text += line("references", format_count(counts.references));
  text += line("duplicates",
               fmt::format("{} ({:.1f} % of the triangles)", format_count(counts.references - distinct),
                           distinct == 0 ? 0.0
                                         : 100.0 * static_cast<double>(counts.references - distinct) /
                                               static_cast<double>(distinct)));
  text += line("SAH", fmt::format("{:.4f}", sah));
  text += line("EPO", fmt::format("{:.4f}", epo));
  text += line("LCV", fmt::format("{:.4f}", lcv));
  text += "\ntraced structure\n";
  text += line("nodes", format_count(bvh.statistics().nodes));
  text += line("bytes", format_count(bvh.statistics().bytes));
  return text;
}

void run(const Options& options) {
  const kerf::BuilderInfo builder = parse_builder("--builder", options.builder);
  const Scene scene = std::move(load_scenes({options.scene}).front());
  write_output(standard_output, name_errors(scene, [&] { return describe(scene, builder); }));
}

}  // namespace

void add_info_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("info", "Say what a scene is and what its tree looks like");
  command->add_option("SCENE", options->scene, scene_help)->type_name("")->required();
  command->add_option("--builder", options->builder, builder_names())
      ->type_name("NAME")
      ->capture_default_str();
  command->callback([options] { run(*options); });
}

}  // namespace kerf_tool
