#include "workbench/bench/report.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "workbench/bench/report_parts.hpp"
#include "workbench/terminal/table.hpp"

namespace workbench {
namespace {

bool is_kerf(const BenchResult& result) {
  return result.engine == "kerf";
}

std::string label(const BenchResult& result) {
  return is_kerf(result) ? result.engine + " " + result.mode : result.engine;
}

// The result of `scene` for what `wanted` measured on another one.
const BenchResult* find(const BenchScene& scene, const BenchResult& wanted) {
  for (const BenchResult& result : scene.results) {
    if (result.engine == wanted.engine && result.mode == wanted.mode && result.rays_made == wanted.rays_made)
      return &result;
  }
  return nullptr;
}

// Rays one by one, in an array, where those made on the spot were measured as well.
bool is_second_of_two(const BenchScene& scene, const BenchResult& result) {
  BenchResult made = result;
  made.rays_made = RaysMade::made;
  return result.rays_made == RaysMade::array && find(scene, made) != nullptr;
}

bool are_compared(const BenchScene& scene, const BenchResult& kerf, const BenchResult& peer) {
  if (!is_kerf(kerf)) return false;
  if (is_kerf(peer)) {
    return kerf.mode == peer.mode && kerf.rays_made == RaysMade::made && peer.rays_made == RaysMade::array;
  }
  return is_second_of_two(scene, kerf) == is_second_of_two(scene, peer);
}

class GeometricMean {
 public:
  void add(double value) {
    if (!std::isfinite(value) || value <= 0.0) return;  // of rays or engines that there are none of
    sum_ += std::log(value);
    ++count_;
  }
  double value() const { return count_ > 0 ? std::exp(sum_ / static_cast<double>(count_)) : 0.0; }

 private:
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

Ratios ratios(std::span<const BenchScene> scenes, const BenchResult& kerf, const BenchResult& peer) {
  Ratios ratios{.mode = kerf.mode,
                .rays_made = kerf.rays_made,
                .peer = is_kerf(peer) ? label(peer) + ", array" : peer.engine,
                .min_scene = {}};
  GeometricMean all, primary, builds;
  for (const BenchScene& scene : scenes) {
    const BenchResult* ours = find(scene, kerf);
    const BenchResult* theirs = find(scene, peer);
    if (ours == nullptr || theirs == nullptr) continue;
    for (std::size_t i = 0; i < ours->rays.size(); ++i) {
      const std::optional<double> our_speed = ours->rays[i].speed(), their_speed = theirs->rays[i].speed();
      if (!our_speed || !their_speed) continue;
      const double ratio = *our_speed / *their_speed;
      all.add(ratio);
      if (ours->rays[i].type == RayType::primary) primary.add(ratio);
      if (ratios.min == 0.0 || ratio < ratios.min) {
        ratios.min = ratio;
        ratios.min_scene = scene.name;
        ratios.min_type = ours->rays[i].type;
      }
    }
    if (ours->bytes == 0 || theirs->bytes == 0) continue;  // there was nothing to build over
    const double build = theirs->build_ms / ours->build_ms;
    builds.add(build);
    ratios.build_min = ratios.build_min == 0.0 ? build : std::min(ratios.build_min, build);
    const auto share = [](std::size_t a, std::size_t b) {
      return b == 0 ? 0.0 : static_cast<double>(a) / static_cast<double>(b);
    };
    ratios.bytes_max = std::max(ratios.bytes_max, share(ours->bytes, theirs->bytes));
    ratios.peak_bytes_max =
        std::max(ratios.peak_bytes_max, share(ours->build_peak_bytes, theirs->build_peak_bytes));
  }
  ratios.mean = all.value();
  ratios.primary_mean = primary.value();
  ratios.build_mean = builds.value();
  return ratios;
}

std::string format_factor(const char* format, double factor) {
  return factor == 0.0 ? no_figure : fmt::format(fmt::runtime(format), factor);
}

std::string format_scene(const BenchScene& scene, Emphasis emphasis, std::size_t max_width) {
  const auto triangles = static_cast<double>(scene.triangles);
  const auto& results = scene.results;
  std::vector<Column> columns{
      names(results, "engine", label),
      names(results, "isa", [](const BenchResult& r) { return r.isa; }),
      names(results, "rays", [](const BenchResult& r) { return name(r.rays_made); }),
      figures(results, "build ms", "{:.1f}", false, [](const BenchResult& r) { return r.build_ms; }),
      figures(results, "bytes/tri", "{:.1f}", false,
              [=](const BenchResult& r) { return static_cast<double>(r.bytes) / triangles; }),
      figures(results, "peak/tri", "{:.1f}", false,
              [=](const BenchResult& r) { return static_cast<double>(r.build_peak_bytes) / triangles; }),
  };
  for (const RayType type : ray_types) {
    columns.push_back(speeds(results, type));
    columns.push_back(figures(results, "hits", "{:.0f}", true, [type](const BenchResult& r) {
      return static_cast<double>(r.rays[static_cast<std::size_t>(type)].hits);
    }));
    for (Cell& cell : columns.back().cells) cell.best = false;
  }
  const std::string facts =
      scene.instances != 0
          ? fmt::format("{} of {}, {}", format_count(scene.instances, "instance", "instances"),
                        format_count(scene.meshes, "mesh", "meshes"),
                        format_count(scene.triangles, "triangle", "triangles"))
          : fmt::format("{}, {}, SAH {:.2f}", format_count(scene.triangles, "triangle", "triangles"),
                        format_count(scene.references, "reference", "references"), scene.sah);
  std::string text =
      fold_text(fmt::format("{}: {}", scene.name, facts), max_width) + format(columns, emphasis, max_width);
  for (const std::string& remark : scene.remarks) text += fold_text("Note: " + remark, max_width);
  return text + "\n";
}

// How fast kerf could be at best, and which fraction of that it reaches.
std::string format_limits(const BenchScene& scene, std::size_t max_width) {
  if (!scene.limits) return {};
  const Limits& limits = *scene.limits;
  std::vector<Column> columns{{.head = "rays", .cells = {}, .left_aligned = true},
                              {.head = "steps", .cells = {}},
                              {.head = "leaves", .cells = {}},
                              {.head = "floor ns", .cells = {}}};
  for (std::size_t i = 0; i < std::size(ray_types); ++i) {
    const StepCounts& counts = limits.counts[i];
    columns[0].cells.push_back({std::string(name(ray_types[i]))});
    columns[1].cells.push_back({fmt::format("{:.2f}", counts.nodes)});
    columns[2].cells.push_back({fmt::format("{:.2f}", counts.leaves)});
    columns[3].cells.push_back({fmt::format("{:.1f}", floor_ns(limits.times, counts))});
  }
  for (const BenchResult& result : scene.results) {
    if (!is_kerf(result) || is_second_of_two(scene, result)) continue;
    Column took{.head = result.mode + " ns", .cells = {}}, reached{.head = "efficiency", .cells = {}};
    for (std::size_t i = 0; i < result.rays.size(); ++i) {
      const std::optional<double> speed = result.rays[i].speed();
      if (!speed) {
        took.cells.push_back({no_figure});
        reached.cells.push_back({no_figure});
        continue;
      }
      took.cells.push_back({fmt::format("{:.1f}", 1e3 / *speed)});
      reached.cells.push_back(
          {fmt::format("{:.2f}", efficiency(floor_ns(limits.times, limits.counts[i]), *speed))});
    }
    columns.push_back(std::move(took));
    columns.push_back(std::move(reached));
  }
  const std::string floor = fmt::format(
      "Floor: {:.2f} ns per node and {:.2f} ns per leaf, with everything in the first-level cache",
      limits.times.node_ns, limits.times.leaf_ns);
  return fold_text(floor, max_width) + format(columns, Emphasis::mark, max_width) + "\n";
}

nlohmann::ordered_json limits_json(const BenchScene& scene) {
  const Limits& limits = *scene.limits;
  nlohmann::ordered_json rays;
  for (std::size_t i = 0; i < std::size(ray_types); ++i) {
    const StepCounts& counts = limits.counts[i];
    const double floor = floor_ns(limits.times, counts);
    nlohmann::ordered_json efficiencies;
    for (const BenchResult& result : scene.results) {
      if (!is_kerf(result) || is_second_of_two(scene, result)) continue;
      if (const std::optional<double> speed = result.rays[i].speed())
        efficiencies[result.mode] = efficiency(floor, *speed);
    }
    rays[std::string(name(ray_types[i]))] = {{"steps", counts.nodes},
                                             {"leaves", counts.leaves},
                                             {"floor_ns", floor},
                                             {"efficiency", efficiencies}};
  }
  return {{"node_ns", limits.times.node_ns}, {"leaf_ns", limits.times.leaf_ns}, {"rays", std::move(rays)}};
}

std::string format_ratios(std::span<const BenchScene> scenes, std::size_t max_width) {
  const std::vector<Ratios> list = ratios_to_peers(scenes);
  if (list.empty()) return {};
  std::vector<Column> columns{{.head = "kerf", .cells = {}, .left_aligned = true},
                              {.head = "rays", .cells = {}, .left_aligned = true},
                              {.head = "relative to", .cells = {}, .left_aligned = true},
                              {.head = "speed", .cells = {}},
                              {.head = "primary", .cells = {}},
                              {.head = "min", .cells = {}},
                              {.head = "where", .cells = {}, .left_aligned = true},
                              {.head = "build", .cells = {}},
                              {.head = "min", .cells = {}},
                              {.head = "bytes", .cells = {}},
                              {.head = "peak", .cells = {}}};
  for (const Ratios& r : list) {
    const std::string cells[] = {
        r.mode,
        std::string(name(r.rays_made)),
        r.peer,
        format_factor("{:.2f}x", r.mean),
        format_factor("{:.2f}x", r.primary_mean),
        format_factor("{:.2f}x", r.min),
        r.min == 0.0 ? no_figure : fmt::format("{}, {}", r.min_scene, name(r.min_type)),
        format_factor("{:.2f}x", r.build_mean),
        format_factor("{:.2f}x", r.build_min),
        format_factor("{:.2f}", r.bytes_max),
        format_factor("{:.2f}", r.peak_bytes_max)};
    for (std::size_t c = 0; c < columns.size(); ++c) columns[c].cells.push_back({cells[c]});
  }
  return fold_text(
             "Speed and build: kerf's speed divided by the peer's, geometric means over scenes and types of "
             "rays.",
             max_width) +
         fold_text("Bytes and peak: kerf's memory divided by the peer's, in the scene where that is largest.",
                   max_width) +
         format(columns, Emphasis::mark, max_width);
}

}  // namespace

std::vector<Ratios> ratios_to_peers(std::span<const BenchScene> scenes) {
  std::vector<Ratios> list;
  if (scenes.empty()) return list;
  for (const BenchResult& kerf : scenes[0].results) {
    for (const BenchResult& peer : scenes[0].results) {
      if (are_compared(scenes[0], kerf, peer)) list.push_back(ratios(scenes, kerf, peer));
    }
  }
  return list;
}

std::string format_bench(std::span<const BenchScene> scenes, Emphasis emphasis, std::size_t max_width) {
  std::string text;
  for (const BenchScene& scene : scenes)
    text += format_scene(scene, emphasis, max_width) + format_limits(scene, max_width);
  return text + format_ratios(scenes, max_width);
}

nlohmann::ordered_json to_json(std::span<const BenchScene> scenes, const BenchRun& run) {
  auto list = nlohmann::ordered_json::array();
  for (const BenchScene& scene : scenes) {
    auto results = nlohmann::ordered_json::array();
    for (const BenchResult& result : scene.results) {
      nlohmann::ordered_json entry{{"engine", result.engine},
                                   {"mode", result.mode},
                                   {"isa", result.isa},
                                   {"rays_made", name(result.rays_made)},
                                   {"build_ms", result.build_ms},
                                   {"bytes", result.bytes},
                                   {"build_peak_bytes", result.build_peak_bytes}};
      if (is_kerf(result)) {
        entry["sah"] = scene.sah;
        entry["references"] = scene.references;
      }
      entry["rays"] = rays_json(result.rays);
      results.push_back(std::move(entry));
    }
    nlohmann::ordered_json one{{"name", scene.name}, {"triangles", scene.triangles}};
    if (scene.instances != 0) {
      one["instances"] = scene.instances;
      one["meshes"] = scene.meshes;
    }
    one["results"] = std::move(results);
    list.push_back(std::move(one));
    if (!scene.remarks.empty()) list.back()["remarks"] = scene.remarks;
    if (scene.limits) list.back()["limits"] = limits_json(scene);
  }
  return scenes_json(run, std::move(list));
}

}  // namespace workbench
