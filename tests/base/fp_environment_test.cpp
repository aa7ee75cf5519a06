// Callers may use other floating-point modes: flushed denormals, as Embree's manual asks, or directed
// rounding.
#include <cfenv>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/inspect.hpp>
#include <kerf/kerf.hpp>

#include "support/adversarial.hpp"
#include "support/build_options.hpp"
#include "support/instrumented.hpp"
#include "support/temporary_directory.hpp"
#include "workbench/generate/solids.hpp"
#include "workbench/rays/aimed_rays.hpp"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace kerf {
namespace {

// A floating-point mode other than the default. `run` calls `work` in it, and expects that `work` leaves it.
class Mode {
 public:
  static std::vector<Mode> all() {
    std::vector<Mode> modes{{"upward", FE_UPWARD}, {"downward", FE_DOWNWARD}, {"toward zero", FE_TOWARDZERO}};
#if defined(__SSE2__)
    modes.push_back(flushing());
#endif
    return modes;
  }
  static Mode flushing() {
    return {"denormals are zeros", FE_TONEAREST, 0x8040u};
  }

  const char* name() const {
    return name_;
  }

  template <class Work>
  void run(const Work& work) const {
    std::fenv_t before;
    std::fegetenv(&before);
    std::fesetround(rounding_);
#if defined(__SSE2__)
    _mm_setcsr(_mm_getcsr() | flush_);
    const unsigned set = _mm_getcsr();
#endif
    work();
#if defined(__SSE2__)
    constexpr unsigned flags = 0x3f;  // the exceptions so far, which any arithmetic sets
    const unsigned left = _mm_getcsr();
#endif
    const int rounding = std::fegetround();
    std::fesetenv(&before);
#if defined(__SSE2__)
    EXPECT_EQ(left & ~flags, set & ~flags) << name_;
#endif
    EXPECT_EQ(rounding, rounding_) << name_;
  }

 private:
  Mode(const char* name, int rounding, unsigned flush = 0)
      : name_(name), rounding_(rounding), flush_(flush) {}

  const char* name_;
  int rounding_;
  unsigned flush_;
};

std::string file_of(const Bvh& bvh) {
  const TemporaryDirectory directory;
  bvh.save(directory / "scene.kerf");
  return read_bytes(directory / "scene.kerf");
}

TEST(FpEnvironment, BuildsAreTheSameWhateverTheCallersThreadIsSetTo) {
  const workbench::Solid solid = workbench::make_torus(96, 48);
  for (const BuilderInfo& info : builders()) {
    for (const unsigned threads : {1u, 2u}) {
      BuildOptions options;
      options.builder = info.builder;
      options.threads = threads;
      const std::string expected = file_of(build(solid.mesh(), options));
      for (const Mode& mode : Mode::all()) {
        Bvh bvh;
        mode.run([&] { bvh = build(solid.mesh(), options); });
        EXPECT_EQ(file_of(bvh), expected) << mode.name();
      }
    }
  }
}

TEST(FpEnvironment, QueriesAndSpansAnswerTheSameWhateverTheCallersThreadIsSetTo) {
  std::mt19937 random(1);
  const adversarial::Soup soup = adversarial::soup(300, [&] { return adversarial::grid_point(random, 3); });
  const Bvh bvh = build(soup.mesh(), spatial_splits_everywhere());
  std::vector<Ray> rays;
  for (int i = 0; i < 2000; ++i) {
    rays.push_back(
        {.origin = adversarial::grid_point(random, 5),
         .direction = i % 2 ? adversarial::grid_point(random, 2) : adversarial::uniform_point(random, 1)});
  }
  struct Answers {
    std::vector<Hit> closest, all;
    std::vector<std::uint8_t> occluded;
    std::vector<bool> contains;
    std::vector<std::optional<SurfacePoint>> near;
    std::vector<SurfacePoint> within;
    std::vector<PrimitiveId> in;
    bool operator==(const Answers&) const = default;
  };
  const auto ask = [&] {
    Answers answers;
    answers.closest.resize(rays.size());
    answers.occluded.resize(rays.size());
    bvh.intersect(rays, answers.closest);
    bvh.occluded(rays, answers.occluded);
    for (std::size_t i = 0; i < rays.size(); i += 4) {
      const Vec3f p = rays[i].origin;
      bvh.all_hits(rays[i], [&](const Hit& hit) { answers.all.push_back(hit); });
      answers.contains.push_back(bvh.contains(p));
      answers.near.push_back(bvh.closest_point(p));
      for (const SurfacePoint& found : bvh.within(p, 1.0f)) answers.within.push_back(found);
      for (const PrimitiveId& found : bvh.triangles_in({p, {p.x + 1, p.y + 1, p.z + 1}}))
        answers.in.push_back(found);
    }
    return answers;
  };
  const Answers expected = ask();
  for (const Mode& mode : Mode::all()) {
    Answers answers;
    mode.run([&] { answers = ask(); });
    EXPECT_TRUE(answers == expected) << mode.name();
  }
}

#if defined(__SSE2__)
TEST(FpEnvironment, SingleRaysAreAsWatertightWhereDenormalsAreFlushed) {
  for (const workbench::NamedSolid& named : workbench::make_watertight_solids()) {
    const Bvh bvh = build(named.solid.mesh(), spatial_splits_everywhere());
    Mode::flushing().run([&] {
      const workbench::AimedRayCounts counts =
          workbench::trace_aimed_rays(named.solid, bvh, test::reduced(10000), 1);
      EXPECT_EQ(counts.leaks, 0u) << named.name;
      EXPECT_EQ(counts.parity_errors, 0u) << named.name;
    });
  }
}
#endif

}  // namespace
}  // namespace kerf
