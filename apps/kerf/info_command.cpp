#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <kerf/inspect.hpp>
#include <kerf/version.hpp>

#include "arguments.hpp"
#include "commands.hpp"
#include "output.hpp"
#include "run_json.hpp"
#include "workbench/compare/measures.hpp"
#include "workbench/scene/placed.hpp"
#include "workbench/scene/surface.hpp"
#include "workbench/terminal/progress.hpp"
#include "workbench/terminal/table.hpp"
#include "workbench/terminal/terminal.hpp"

namespace kerf_tool {
namespace {

using namespace workbench;
using Json = nlohmann::ordered_json;

struct Options {
  std::string scene;
  std::string builder;  // empty: that of a .kerf file, else sbvh
  std::string format;
  std::string json;
};

// What is known of a tree: of the binary tree of a builder, or of the wide one that a file holds.
struct TreeFacts {
  std::string title;
  kerf::TreeCounts counts;
  std::size_t distinct = 0;  // triangles that stand in some leaf
  double sah = 0.0;
  std::optional<kerf::Estimate> epo = {};  // of binary trees
  std::optional<double> lcv = {};          // of binary trees

  std::size_t duplicates() const { return counts.references - distinct; }
};

// What standing at places costs, and what it saves.
struct PlaceFacts {
  std::size_t instances = 0, meshes = 0, stored_triangles = 0;
  std::size_t bytes = 0;         // of the scene and of each hierarchy once
  std::size_t copied_bytes = 0;  // of the hierarchies, if each copy had its own
};

struct Facts {
  SurfaceFacts surface;
  kerf::BvhStatistics traced;
  kerf::Box3f bounds;
  TreeFacts tree;
  std::optional<PlaceFacts> places = {};  // of meshes at places; `tree` and `traced` are of all meshes then
};

std::size_t count_distinct(std::vector<std::uint32_t> ids) {
  std::sort(ids.begin(), ids.end());
  return static_cast<std::size_t>(std::unique(ids.begin(), ids.end()) - ids.begin());
}

TreeFacts facts_of(const kerf::Tree& tree, std::string_view builder) {
  const auto references = tree.references();
  return {.title = fmt::format("{} tree", builder),
          .counts = count_tree(tree),
          .distinct = count_distinct({references.begin(), references.end()}),
          .sah = surface_area_cost(tree),
          .epo = estimate_end_point_overlap(tree),
          .lcv = leaf_count_variability(tree)};
}

// The surface area heuristic with the same costs, where a node of many children is visited as one.
TreeFacts facts_of_saved(const kerf::Bvh& bvh) {
  const kerf::Layout layout = kerf::layout(bvh);
  TreeFacts facts{.title = fmt::format("saved tree, of nodes with up to {} children", layout.width),
                  .counts = {}};
  const auto area = [](const kerf::Box3f& box) {
    const double x = double{box.upper.x} - box.lower.x, y = double{box.upper.y} - box.lower.y,
                 z = double{box.upper.z} - box.lower.z;
    return x * y + y * z + z * x;
  };
  double cost = kerf::inner_node_cost * area(layout.bounds);
  facts.counts.nodes = layout.node_count;
  facts.counts.depth = layout.depth;
  layout.with_nodes([&](const auto& nodes) {
    for (const auto& node : nodes) {
      for (std::uint32_t slot = 0; slot < layout.width; ++slot) {
        const kerf::Box3f box = child_box(node, slot);
        if (box.empty()) continue;
        const kerf::ChildLink child = node.children[slot];
        cost += area(box) * (child.is_leaf() ? kerf::triangle_cost * child.count() : kerf::inner_node_cost);
        if (!child.is_leaf()) continue;
        ++facts.counts.nodes;
        ++facts.counts.leaves;
        facts.counts.references += child.count();
        facts.counts.leaf_sizes.resize(
            std::max<std::size_t>(facts.counts.leaf_sizes.size(), child.count() + 1));
        ++facts.counts.leaf_sizes[child.count()];
      }
    }
  });
  const double whole = area(layout.bounds);
  facts.sah = whole > 0.0 ? cost / whole : 0.0;
  std::vector<std::uint32_t> ids;
  visit_triangles(layout, [&](std::uint32_t id, const kerf::Triangle&) { ids.push_back(id); });
  facts.distinct = count_distinct(std::move(ids));
  return facts;
}

void add(TreeFacts& sum, const TreeFacts& tree) {
  sum.counts.nodes += tree.counts.nodes;
  sum.counts.leaves += tree.counts.leaves;
  sum.counts.depth = std::max(sum.counts.depth, tree.counts.depth);
  sum.counts.references += tree.counts.references;
  std::vector<std::size_t>& sizes = sum.counts.leaf_sizes;
  sizes.resize(std::max(sizes.size(), tree.counts.leaf_sizes.size()));
  for (std::size_t i = 0; i < tree.counts.leaf_sizes.size(); ++i) sizes[i] += tree.counts.leaf_sizes[i];
  sum.distinct += tree.distinct;
}

// A surface is closed where each of its meshes is.
Facts find_facts_of_places(const PlacedMeshes& placed, ProgressBar& bar) {
  Facts facts;
  bar.show(0.0, "build");
  const std::vector<kerf::Bvh> objects = build_objects(placed);
  const kerf::Scene scene = build_scene(placed, objects);
  facts.bounds = bounds_of(placed, objects);
  facts.places = {.instances = placed.places.size(),
                  .meshes = placed.meshes.size(),
                  .stored_triangles = placed.stored_triangles(),
                  .bytes = scene.bytes()};
  facts.tree = {.title = "trees of all meshes, of nodes with many children", .counts = {}};
  std::vector<std::size_t> copies(objects.size(), 0);
  for (const PlacedMeshes::Place& place : placed.places) ++copies[place.mesh];
  for (std::size_t i = 0; i < objects.size(); ++i) {
    bar.show(0.5 + 0.5 * static_cast<double>(i) / static_cast<double>(objects.size()), "meshes");
    Scene alone;
    alone.vertices = placed.meshes[i].vertices;
    alone.triangles = placed.meshes[i].triangles;
    const SurfaceFacts surface = surface_facts(alone);
    facts.surface.open_edges += surface.open_edges;
    facts.surface.doubled_triangles += surface.doubled_triangles;
    const kerf::BvhStatistics& traced = objects[i].statistics();
    facts.traced.degenerate_triangles += traced.degenerate_triangles;
    facts.traced.nodes += traced.nodes;
    facts.traced.bytes += traced.bytes;
    facts.places->bytes += traced.bytes;
    facts.places->copied_bytes += copies[i] * traced.bytes;
    add(facts.tree, facts_of_saved(objects[i]));
  }
  return facts;
}

Facts find_facts(const Scene& scene, const Options& options) {
  ProgressBar bar;
  if (scene.placed) return find_facts_of_places(*scene.placed, bar);
  Facts facts;
  bar.show(0.0, "surface");
  facts.surface = surface_facts(scene);
  kerf::Bvh bvh;
  if (scene.hierarchy && options.builder.empty()) {
    bvh = *scene.hierarchy;
    facts.tree = facts_of_saved(bvh);
  } else {
    const kerf::BuilderInfo builder =
        parse_builder("--builder", options.builder.empty() ? "sbvh" : options.builder);
    kerf::BuildOptions build{.builder = builder.builder};
    build.progress = [&](float fraction) {
      bar.show(0.2 + 0.2 * fraction, "build");
      return true;
    };
    const kerf::Tree tree = kerf::build_tree(scene.mesh(), build);
    bar.show(0.4, "measures of the tree");
    facts.tree = facts_of(tree, builder.name);
    bar.show(0.9, "layout");
    bvh = kerf::make_bvh(tree);
  }
  facts.traced = bvh.statistics();
  facts.bounds = bvh.bounds();
  return facts;
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

std::string describe(const Scene& scene, const Facts& facts, std::size_t columns) {
  constexpr std::size_t values_begin = 24;
  const auto line = [=](std::string_view name, const std::string& value) {
    return beside_name(fmt::format("  {}", name), value, values_begin, columns);
  };
  const kerf::Box3f& box = facts.bounds;
  const TreeFacts& tree = facts.tree;
  std::string text = scene.name + "\n";
  if (facts.places) {
    const PlaceFacts& places = *facts.places;
    text += line("instances", fmt::format("{} of {}", format_count(places.instances),
                                          format_count(places.meshes, "mesh", "meshes")));
    text += line("triangles", fmt::format("{}, of {} in meshes", format_count(scene.triangle_count()),
                                          format_count(places.stored_triangles)));
  } else {
    text += line("vertices", format_count(scene.vertices.size()));
    text += line("triangles", format_count(scene.triangles.size()));
  }
  text += line("degenerate", format_count(facts.traced.degenerate_triangles));
  text += line("doubled", format_count(facts.surface.doubled_triangles));
  text += line("closed", facts.surface.closed()
                             ? "yes"
                             : fmt::format("no: {} no counterpart",
                                           format_count(facts.surface.open_edges, "edge has", "edges have")));
  if (const std::size_t flattened = scene.contents.flattened_triangles)
    text += line("flattened", format_count(flattened, "triangle", "triangles") + ", by rounding to floats");
  const std::string lower = format_point(box.lower), upper = format_point(box.upper);
  if (box.empty()) {
    text += line("bounds", "empty");
  } else if (lower.size() + upper.size() < 50) {
    text += line("bounds", fmt::format("{} to {}", lower, upper));
  } else {
    text += line("bounds", lower + " to") + line("", upper);
  }
  if (!box.empty())
    text += line("size",
                 fmt::format("{:.6g} x {:.6g} x {:.6g}, in the units of the file", box.upper.x - box.lower.x,
                             box.upper.y - box.lower.y, box.upper.z - box.lower.z));
  text += line("viewpoints", format_count(scene.viewpoints.size()));
  std::string beside;
  for (const auto& [name, value] : scene.contents.entries)
    if (!facts.places || name != "instances") beside += line(name, value);  // told above
  if (!beside.empty()) text += "\nbeside triangles\n" + beside;
  text += fmt::format("\n{}\n", tree.title);
  text += line("nodes", format_count(tree.counts.nodes));
  text += line("leaves", format_count(tree.counts.leaves));
  text += line("depth", format_count(tree.counts.depth));
  text += line("leaf sizes", format_leaf_sizes(tree.counts.leaf_sizes));
  text += line("references", format_count(tree.counts.references));
  const auto distinct = static_cast<double>(std::max<std::size_t>(tree.distinct, 1));
  text += line("duplicates", fmt::format("{} ({:.1f} % of the triangles)", format_count(tree.duplicates()),
                                         100.0 * static_cast<double>(tree.duplicates()) / distinct));
  if (!facts.places) text += line("SAH", fmt::format("{:.4f}", tree.sah));
  if (tree.epo && tree.epo->standard_error > 0.0)
    text += line("EPO", fmt::format("{:.4g}, from a sample; standard error {:.1g}", tree.epo->value,
                                    tree.epo->standard_error));
  else if (tree.epo)
    text += line("EPO", fmt::format("{:.4f}", tree.epo->value));
  if (tree.lcv) text += line("LCV", fmt::format("{:.4f}", *tree.lcv));
  text += "\ntraced structure\n";
  text += line("nodes", format_count(facts.traced.nodes));
  text += line("bytes", format_count(facts.traced.bytes));
  if (facts.places) {
    const PlaceFacts& places = *facts.places;
    text += line("with all instances", fmt::format("{} bytes", format_count(places.bytes)));
    if (places.copied_bytes > places.bytes) {
      text += line("saved by sharing",
                   fmt::format("{} bytes, {:.1f} times what there is",
                               format_count(places.copied_bytes - places.bytes),
                               static_cast<double>(places.copied_bytes - places.bytes) /
                                   static_cast<double>(std::max<std::size_t>(places.bytes, 1))));
    }
  }
  return text;
}

Json to_json(const Scene& scene, const Facts& facts) {
  const auto point = [](const kerf::Vec3f& p) { return Json::array({p.x, p.y, p.z}); };
  const TreeFacts& tree = facts.tree;
  Json bounds;  // null if there are none
  if (!facts.bounds.empty())
    bounds = {{"lower", point(facts.bounds.lower)}, {"upper", point(facts.bounds.upper)}};
  Json beside = Json::object();
  for (const auto& [name, value] : scene.contents.entries) beside[name] = value;
  Json of_tree{{"title", tree.title},
               {"nodes", tree.counts.nodes},
               {"leaves", tree.counts.leaves},
               {"depth", tree.counts.depth},
               {"leaf_sizes", tree.counts.leaf_sizes},
               {"references", tree.counts.references},
               {"duplicates", tree.duplicates()},
               {"sah", facts.places ? Json() : Json(tree.sah)}};
  if (tree.epo) {
    of_tree["epo"] = tree.epo->value;
    of_tree["epo_standard_error"] = tree.epo->standard_error;
  }
  if (tree.lcv) of_tree["lcv"] = *tree.lcv;
  Json of_places;  // null for one mesh
  if (facts.places) {
    of_places = {{"instances", facts.places->instances},
                 {"meshes", facts.places->meshes},
                 {"triangles", facts.places->stored_triangles},
                 {"bytes", facts.places->bytes},
                 {"bytes_if_copied", facts.places->copied_bytes}};
  }
  return {{"kerf", KERF_VERSION},
          {"name", scene.name},
          {"vertices", facts.places ? Json() : Json(scene.vertices.size())},
          {"triangles", scene.triangle_count()},
          {"shared", std::move(of_places)},
          {"degenerate_triangles", facts.traced.degenerate_triangles},
          {"doubled_triangles", facts.surface.doubled_triangles},
          {"flattened_triangles", scene.contents.flattened_triangles},
          {"closed", facts.surface.closed()},
          {"open_edges", facts.surface.open_edges},
          {"bounds", std::move(bounds)},
          {"viewpoints", scene.viewpoints.size()},
          {"beside_triangles", std::move(beside)},
          {"tree", std::move(of_tree)},
          {"traced", {{"nodes", facts.traced.nodes}, {"bytes", facts.traced.bytes}}}};
}

void run(const Options& options) {
  if (!options.builder.empty()) parse_builder("--builder", options.builder);
  if (!options.json.empty()) require_writable(options.json);
  const Repeats repeats = options.builder.empty() ? Repeats::kept : Repeats::flattened;
  const Scene scene = std::move(load_scenes({options.scene}, options.format, repeats).front());
  const Facts facts = name_errors(scene, [&] { return find_facts(scene, options); });
  if (!options.json.empty()) write_output(options.json, dump_json(to_json(scene, facts)));
  if (options.json != standard_output)
    write_output(standard_output, describe(scene, facts, columns_of(stdout)));
}

}  // namespace

void add_info_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("info", "Say what a scene is and what its tree looks like");
  command->add_option("SCENE", options->scene, scene_help)->type_name("")->required();
  command
      ->add_option("--builder", options->builder,
                   builder_names() + "; if none is given, the hierarchy of a .kerf file, else sbvh")
      ->type_name(builder_names("|", "|"));
  command->add_option("--json", options->json, "Write all of it as JSON to this file; - is standard output")
      ->check(names_a_file())
      ->type_name("FILE");
  add_format_option(*command, options->format);
  command->callback([options] { run(*options); });
}

}  // namespace kerf_tool
