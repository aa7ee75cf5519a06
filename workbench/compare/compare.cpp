#include "workbench/compare/compare.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <kerf/inspect.hpp>

#include "workbench/compare/device.hpp"
#include "workbench/compare/equal_references.hpp"
#include "workbench/compare/measures.hpp"
#include "workbench/compare/trace.hpp"

namespace workbench {
namespace {

using Clock = std::chrono::steady_clock;

// Each build is timed this many times, unless one round of all contenders takes `long_round` seconds or more:
// a busy machine then adds little to the time of a build, compared with that time.
constexpr unsigned build_rounds = 3;
constexpr double long_round = 10.0;

// A device disturbs its own timing less than other programs disturb that of a core: it is timed for this part
// of the seconds. A call takes `min_call` or more, whatever the device's clock says.
constexpr double device_share = 0.1;
constexpr double min_call = 1e-5;

// Where the stages end on the progress bar, roughly.
constexpr double first_build_end = 0.3;  // the measures of the trees included
constexpr double builds_end = 0.5;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

bool pre_splits(kerf::Builder builder) {
  return builder == kerf::Builder::esc || builder == kerf::Builder::evh;
}

// Lets every builder that splits before it builds make as many references as the SBVH with the same alpha and
// the same bound of its references has.
std::vector<Contender> with_equal_references(const kerf::TriangleMesh& mesh,
                                             std::span<const Contender> contenders, unsigned threads) {
  std::vector<Contender> result(contenders.begin(), contenders.end());
  std::map<std::pair<float, float>, std::size_t> references_of_sbvh;
  for (Contender& contender : result) {
    contender.options.threads = threads;
    if (!pre_splits(contender.options.builder) || contender.options.presplit_references != 0) continue;
    kerf::BuildOptions options = contender.options;
    options.quality = kerf::Quality::fast;  // a better tree has the same references
    const auto [place, is_new] =
        references_of_sbvh.try_emplace({options.alpha, options.max_reference_ratio}, 0);
    if (is_new) {
      kerf::BuildOptions sbvh = options;
      sbvh.builder = kerf::Builder::sbvh;
      place->second = count_references(mesh, sbvh);
    }
    contender.options.presplit_references = presplit_references_for(place->second, mesh, options);
  }
  return result;
}

std::size_t count_differences(std::span<const kerf::Hit> hits, std::span<const kerf::Hit> others) {
  return std::inner_product(hits.begin(), hits.end(), others.begin(), std::size_t{0}, std::plus<>(),
                            [](const kerf::Hit& a, const kerf::Hit& b) { return std::size_t{!(a == b)}; });
}

// Where nothing can be split, a sweep over alpha builds one tree again and again, and measuring it takes
// longer than building it.
bool are_equal(const kerf::Tree& a, const kerf::Tree& b) {
  const auto same_nodes = [](const kerf::BinaryNode& p, const kerf::BinaryNode& q) {
    return p.bounds.lower == q.bounds.lower && p.bounds.upper == q.bounds.upper && p.first == q.first &&
           p.count == q.count;
  };
  return std::ranges::equal(a.references(), b.references()) &&
         std::ranges::equal(a.nodes(), b.nodes(), same_nodes);
}

void copy_measures(const BuilderFigures& from, BuilderFigures& to) {
  to.sah = from.sah;
  to.epo = from.epo;
  to.epo_error = from.epo_error;
  to.lcv = from.lcv;
}

// The measurement of one scene, stage after stage.
class Measurement {
 public:
  Measurement(const Scene& scene, std::span<const Contender> contenders, const CompareOptions& options)
      : scene_(scene), options_(options), mesh_(scene.mesh()) {
    report(0.0, "equal references");
    contenders_ = with_equal_references(mesh_, contenders, options.threads);
    result_.figures.name = scene.name;
    result_.figures.triangles = mesh_.triangles.size();
    if (options.device != nullptr) {
      result_.figures.device = options.device->name();
      structures_ = options.device->structures();
    }
    for (const Contender& contender : contenders_) {
      for (const std::string& structure : structures_) {
        BuilderFigures& figures = result_.figures.builders.emplace_back();
        figures.name = contender.name;
        figures.structure = structure;
        figures.alpha = contender.options.alpha;
        figures.budget = contender.options.max_reference_ratio;
        figures.build_ms = std::numeric_limits<double>::infinity();
      }
    }
  }

  Comparison run() {
    for (std::size_t i = 0; i < contenders_.size(); ++i) build_first(i);
    for (unsigned round = 1; round < build_rounds && build_seconds_ < long_round; ++round) {
      report(first_build_end + (builds_end - first_build_end) * (round - 1) / (build_rounds - 1),
             "build again");
      for (std::size_t i = 0; i < contenders_.size(); ++i) build(i, [](const kerf::Tree&) {});
    }
    bound_rays();
    for (const RayType type : ray_types) trace(type);
    if (!hits_anything()) remark("no ray hits anything, so that speeds are those of finding nothing");
    report(1.0, "done");
    return std::move(result_);
  }

 private:
  void report(double fraction, std::string_view what) const {
    if (options_.progress) options_.progress(fraction, what);
  }

  void remark(const std::string& what) {
    std::string& all = result_.figures.remark;
    all += (all.empty() ? "" : "; ") + what;
  }

  bool hits_anything() const {
    const auto& rays = result_.figures.builders.front().rays;
    return std::any_of(rays.begin(), rays.end(), [](const RayFigures& figures) { return figures.hits > 0; });
  }

  // Builds and measures the time, without that of `inspect`, which is given the tree.
  template <class Inspect>
  kerf::Bvh build(std::size_t i, const Inspect& inspect) {
    auto start = Clock::now();
    const kerf::Tree tree = kerf::build_tree(mesh_, contenders_[i].options);
    double seconds = seconds_since(start);
    inspect(tree);
    start = Clock::now();
    kerf::Bvh bvh = kerf::make_bvh(tree);
    seconds += seconds_since(start);
    build_seconds_ += seconds;
    for (BuilderFigures& figures : figures_of(i))
      figures.build_ms = std::min(figures.build_ms, 1e3 * seconds);
    return bvh;
  }

  // Of contender `i`: one for each structure that is traced.
  std::span<BuilderFigures> figures_of(std::size_t i) {
    return std::span(result_.figures.builders).subspan(i * structures_.size(), structures_.size());
  }

  void build_first(std::size_t i) {
    const std::span<BuilderFigures> rows = figures_of(i);
    const double step = first_build_end / static_cast<double>(contenders_.size());
    report(step * static_cast<double>(i), "build " + rows[0].name);
    const kerf::Bvh bvh = build(i, [&](const kerf::Tree& tree) {
      result_.figures.degenerate_triangles = tree.degenerate_triangles();
      if (i > 0 && are_equal(tree, measured_)) {
        copy_measures(figures_of(i - 1)[0], rows[0]);
      } else {
        report(step * (static_cast<double>(i) + 0.5), "measure " + rows[0].name);
        rows[0].sah = surface_area_cost(tree);
        const kerf::Estimate epo = estimate_end_point_overlap(tree);
        rows[0].epo = epo.value;
        rows[0].epo_error = epo.standard_error;
        rows[0].lcv = leaf_count_variability(tree);
        measured_ = tree;
      }
      for (std::size_t structure = 0; options_.device != nullptr && structure < rows.size(); ++structure)
        uploaded_.push_back(options_.device->upload(tree, structure));
    });
    for (std::size_t structure = 0; structure < rows.size(); ++structure) {
      BuilderFigures& figures = rows[structure];
      copy_measures(rows[0], figures);
      if (options_.device != nullptr) {
        const DeviceHierarchy& uploaded = *uploaded_[i * rows.size() + structure];
        figures.references = uploaded.references();
        figures.nodes = uploaded.nodes();
        figures.bytes = uploaded.bytes();
      } else {
        figures.references = bvh.statistics().references;
        figures.nodes = bvh.statistics().nodes;
        figures.bytes = bvh.statistics().bytes;
      }
      result_.hierarchies.push_back(bvh);
    }
  }

  void bound_rays() {
    rays_ = options_.rays;
    if (options_.bound_rays) {
      rays_ = affordable(scene_, result_.hierarchies.front(), options_.rays, options_.max_visits,
                         result_.figures.builders.size());
    }
    if (!(rays_ == options_.rays)) {
      remark(fmt::format(
          "each viewpoint has {}x{} pixels, not {}x{}: so much lies over one another that a ray visits "
          "thousands of nodes and triangles",
          rays_.width, rays_.height, options_.rays.width, options_.rays.height));
    }
    std::set<std::string_view> sampled;  // a builder with several alphas is named once
    double error = 0.0;
    for (const BuilderFigures& figures : result_.figures.builders) {
      if (figures.epo_error > 0.0) sampled.insert(figures.name);
      error = std::max(error, figures.epo_error);
    }
    if (!sampled.empty()) {
      remark(fmt::format("the EPO of {} is from a sample, with a standard error of {:.1g} or less",
                         fmt::join(sampled, ", "), error));
    }
  }

  void trace(RayType type) {
    const auto place = static_cast<std::size_t>(type);
    report(builds_end + (1.0 - builds_end) * static_cast<double>(place) / std::size(ray_types),
           fmt::format("trace {} rays", title(type)));
    const RaySet set = make_rays(scene_, result_.hierarchies.front(), type, rays_);
    // A device's hits must be those of the CPU.
    std::vector<kerf::Hit> expected;
    if (options_.device != nullptr) {
      options_.device->set_rays(set);
      expected = trace_counted(result_.hierarchies.front(), set, options_.threads).hits;
    }
    std::vector<BuilderFigures>& builders = result_.figures.builders;
    for (std::size_t i = 0; i < builders.size(); ++i) {
      CountedPass pass = options_.device != nullptr
                             ? uploaded_[i]->trace_counted()
                             : trace_counted(result_.hierarchies[i], set, options_.threads);
      const double per_ray = set.rays.empty() ? 0.0 : 1.0 / static_cast<double>(set.rays.size());
      builders[i].rays[place] = {.count = set.rays.size(),
                                 .hits = pass.hit_count,
                                 .steps = per_ray * static_cast<double>(pass.steps),
                                 .triangle_tests = per_ray * static_cast<double>(pass.triangle_tests),
                                 .leaf_visits = per_ray * static_cast<double>(pass.leaf_visits)};
      if (i == 0 && options_.device == nullptr)
        expected = std::move(pass.hits);
      else
        builders[i].disagreements += count_differences(pass.hits, expected);
    }
    if (set.rays.empty()) return;
    const std::vector<SliceTimes> times = options_.device != nullptr ? time_on_device() : time_here(set);
    const double mrays = 1e-6 * static_cast<double>(set.rays.size());
    for (std::size_t i = 0; i < builders.size(); ++i) {
      builders[i].rays[place].mrays_per_s = mrays / times[i].seconds;
      builders[i].rays[place].median_mrays_per_s = mrays / times[i].median_round;
    }
  }

  std::vector<SliceTimes> time_here(const RaySet& set) const {
    return time_hierarchies(result_.hierarchies, set,
                            {.rounds = options_.rounds, .seconds = options_.seconds_per_type});
  }

  // Round after round, each hierarchy in turn; the best time of each counts.
  std::vector<SliceTimes> time_on_device() const {
    std::vector<std::vector<double>> rounds(uploaded_.size());
    double total = 0.0;
    for (unsigned round = 0; round < options_.rounds || total < device_share * options_.seconds_per_type;
         ++round) {
      for (std::size_t i = 0; i < uploaded_.size(); ++i) {
        const double seconds = uploaded_[i]->time();
        rounds[i].push_back(seconds);
        total += std::max(seconds, min_call);
      }
    }
    std::vector<SliceTimes> times;
    for (std::vector<double>& of_one : rounds) {
      std::sort(of_one.begin(), of_one.end());
      times.push_back({of_one.front(), of_one[of_one.size() / 2]});
    }
    return times;
  }

  const Scene& scene_;
  const CompareOptions& options_;
  const kerf::TriangleMesh mesh_;
  RaySetOptions rays_;
  std::vector<Contender> contenders_;
  std::vector<std::string> structures_ = {""};
  Comparison result_;
  std::vector<std::unique_ptr<DeviceHierarchy>> uploaded_;  // one for each row of figures
  kerf::Tree measured_;  // the last tree of which the measures were computed
  double build_seconds_ = 0.0;
};

}  // namespace

std::size_t SceneFigures::disagreements() const {
  return std::accumulate(
      builders.begin(), builders.end(), std::size_t{0},
      [](std::size_t sum, const BuilderFigures& figures) { return sum + figures.disagreements; });
}

Comparison compare(const Scene& scene, std::span<const Contender> contenders, const CompareOptions& options) {
  return Measurement(scene, contenders, options).run();
}

}  // namespace workbench
