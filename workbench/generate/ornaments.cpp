#include "workbench/generate/ornaments.hpp"

#include <algorithm>
#include <cmath>

#include "workbench/sampling/angles.hpp"

namespace workbench {

using namespace kerf;

namespace {

// A surface of revolution whose radius and height may vary round the axis: `shape(turns, t)` gives both.
template <class Shape>
void add_carved(MeshMaker& maker, const Vec3f& foot, std::uint32_t segments, std::uint32_t rows,
                Shape&& shape) {
  maker.add_grid(segments, rows, [&](float u, float v) {
    const ProfilePoint p = shape(u, v);
    const auto [sine, cosine] = sine_cosine(u);
    return foot + Vec3f{p.radius * cosine, p.height, -p.radius * sine};
  });
}

float bump(float t, float center, float width) {
  const float x = (t - center) / width;
  return x * x < 1.0f ? (1.0f - x * x) * (1.0f - x * x) : 0.0f;
}

constexpr std::uint32_t flutes = 16;

void add_shaft(MeshMaker& maker, const Vec3f& foot, float height, float radius, const Fineness& fine) {
  add_carved(maker, foot, flutes * fine(3, 1), fine(6, 1), [&](float u, float v) {
    const float entasis = 1.0f - 0.16f * v * v;
    const float at_ends = std::min({1.0f, 12.0f * v, 12.0f * (1.0f - v)});
    const float hollow = 0.5f - 0.5f * sine_cosine(static_cast<double>(u) * flutes).cosine;
    return ProfilePoint{radius * entasis * (1.0f - 0.09f * at_ends * hollow), v * height};
  });
}

void add_capital(MeshMaker& maker, const Vec3f& foot, float height, float radius, const Fineness& fine) {
  add_carved(maker, foot, 8 * fine(5, 1), fine(14, 2), [&](float u, float v) {
    const double turns = u;
    const float lower_leaf = std::max(0.0f, sine_cosine(8.0 * turns).cosine);
    const float upper_leaf = std::max(0.0f, -sine_cosine(8.0 * turns).cosine);
    const float volute = std::max(0.0f, sine_cosine(4.0 * turns + 0.5).cosine);
    const float bell = 0.86f + 0.5f * v * v * v;
    const float leaves = 0.28f * lower_leaf * bump(v, 0.32f, 0.2f) +
                         0.32f * upper_leaf * bump(v, 0.6f, 0.22f) +
                         0.4f * volute * volute * bump(v, 0.88f, 0.13f);
    const float curl = 0.06f * (lower_leaf * bump(v, 0.25f, 0.2f) + upper_leaf * bump(v, 0.5f, 0.22f));
    return ProfilePoint{radius * (bell + leaves), height * (v - curl)};
  });
}

}  // namespace

Fineness::Fineness(double detail) : factor_(std::sqrt(detail)) {}

std::uint32_t Fineness::operator()(double count, std::uint32_t min) const {
  return scaled(count, factor_, min);
}

ProfilePoint profile_at(std::span<const ProfilePoint> profile, float t) {
  const auto last = static_cast<std::ptrdiff_t>(profile.size()) - 1;
  const float place = t * static_cast<float>(last);
  const auto i = std::min(static_cast<std::ptrdiff_t>(place), last - 1);
  const float s = place - static_cast<float>(i);
  const auto at = [&](std::ptrdiff_t k) {
    return profile[static_cast<std::size_t>(std::clamp(k, std::ptrdiff_t{0}, last))];
  };
  const auto spline = [&](float p0, float p1, float p2, float p3) {
    return p1 +
           0.5f * s *
               (p2 - p0 + s * (2.0f * p0 - 5.0f * p1 + 4.0f * p2 - p3 + s * (3.0f * (p1 - p2) + p3 - p0)));
  };
  const ProfilePoint a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
  return {std::max(0.0f, spline(a.radius, b.radius, c.radius, d.radius)),
          spline(a.height, b.height, c.height, d.height)};
}

void add_turned(MeshMaker& maker, const Vec3f& foot, std::span<const ProfilePoint> profile, float scale,
                std::uint32_t segments, std::uint32_t rows) {
  add_carved(maker, foot, segments, rows, [&](float, float v) {
    const ProfilePoint p = profile_at(profile, v);
    return ProfilePoint{scale * p.radius, scale * p.height};
  });
}

void add_column(MeshMaker& maker, const Vec3f& foot, float height, float radius, const Fineness& fine) {
  constexpr ProfilePoint base[] = {{1.30f, 0.00f}, {1.42f, 0.10f}, {1.30f, 0.22f},
                                   {1.12f, 0.26f}, {1.08f, 0.34f}, {1.20f, 0.42f},
                                   {1.24f, 0.50f}, {1.16f, 0.58f}, {1.00f, 0.62f}};
  const float plinth_height = 0.5f * radius, base_height = 0.62f * radius;
  const float capital_height = 2.3f * radius, abacus_height = 0.4f * radius;
  const float shaft_height = height - plinth_height - base_height - capital_height - abacus_height;

  const float plinth = 1.45f * radius, abacus = 1.6f * radius;
  Vec3f at = foot;
  maker.add_box(at - Vec3f{plinth, 0, plinth}, at + Vec3f{plinth, plinth_height, plinth});
  at.y += plinth_height;
  add_turned(maker, at, base, radius, fine(28, 4), fine(12, 1));
  at.y += base_height;
  add_shaft(maker, at, shaft_height, radius, fine);
  at.y += shaft_height;
  add_capital(maker, at, capital_height, 0.9f * radius, fine);
  at.y += capital_height;
  maker.add_box(at - Vec3f{abacus, 0, abacus}, at + Vec3f{abacus, abacus_height, abacus});
}

void add_baluster(MeshMaker& maker, const Vec3f& foot, float height, const Fineness& fine) {
  constexpr ProfilePoint profile[] = {{0.10f, 0.00f}, {0.10f, 0.06f}, {0.06f, 0.10f}, {0.09f, 0.20f},
                                      {0.13f, 0.32f}, {0.10f, 0.46f}, {0.05f, 0.62f}, {0.05f, 0.78f},
                                      {0.08f, 0.84f}, {0.05f, 0.90f}, {0.10f, 0.96f}, {0.10f, 1.00f}};
  add_turned(maker, foot, profile, height, fine(8), fine(12, 2));
}

void add_vase(MeshMaker& maker, const Vec3f& foot, float height, const Fineness& fine) {
  constexpr ProfilePoint profile[] = {{0.22f, 0.00f}, {0.24f, 0.04f}, {0.12f, 0.10f}, {0.10f, 0.15f},
                                      {0.24f, 0.24f}, {0.38f, 0.42f}, {0.40f, 0.58f}, {0.30f, 0.74f},
                                      {0.20f, 0.84f}, {0.22f, 0.92f}, {0.32f, 1.00f}, {0.30f, 1.01f},
                                      {0.18f, 0.93f}, {0.16f, 0.84f}, {0.24f, 0.72f}};
  add_turned(maker, foot, profile, height, fine(40), fine(30, 4));
}

void add_rosette(MeshMaker& maker, const Vec3f& center, const Vec3f& x, const Vec3f& y, float radius,
                 const Fineness& fine) {
  const Vec3f out = cross(x, y);
  maker.add_grid(8 * fine(5, 1), fine(6, 1), [&](float u, float v) {
    const auto [sine, cosine] = sine_cosine(u);
    const float petal = std::abs(sine_cosine(4.0 * static_cast<double>(u)).cosine);
    const float r = (1.0f - 0.98f * v) * radius * (0.72f + 0.28f * petal);  // from the rim inward
    const float relief =
        0.35f * bump(1.0f - v, 0.0f, 0.3f) + 0.3f * (0.3f + petal) * bump(1.0f - v, 0.62f, 0.4f);
    return center + r * cosine * x + r * sine * y + radius * relief * out;
  });
}

void add_ring(MeshMaker& maker, const Vec3f& center, const Vec3f& x, const Vec3f& y, float radius,
              float thickness, std::uint32_t segments, std::uint32_t sides) {
  const Vec3f axis = cross(x, y);
  maker.add_grid(segments, sides, [&](float u, float v) {
    const SineCosine round = sine_cosine(u), tube = sine_cosine(v);
    const Vec3f radial = round.cosine * x + round.sine * y;
    return center + (radius + thickness * tube.cosine) * radial + thickness * tube.sine * axis;
  });
}

void add_drape(MeshMaker& maker, const Vec3f& left, const Vec3f& right, float length, float depth,
               std::uint32_t folds, const Fineness& fine) {
  const Vec3f across = right - left;
  const Vec3f out = normalize(cross(across, {0, 1, 0}));
  maker.add_grid(folds * fine(8, 2), fine(24, 1), [&](float u, float v) {
    const float wave = sine_cosine(static_cast<double>(u) * folds + 0.3 * static_cast<double>(v)).sine;
    const float hem = 1.0f - v;  // v counts upward from the hem
    const float gather = 1.0f - 0.25f * hem * (1.0f - hem) * 2.0f;
    return left + (0.5f + (u - 0.5f) * gather) * across + (depth * (0.35f + 0.65f * hem) * wave) * out -
           Vec3f{0, length * hem, 0};
  });
}

void add_cable(MeshMaker& maker, const Vec3f& from, const Vec3f& to, float sag, float radius,
               std::uint32_t segments, std::uint32_t sides) {
  std::vector<Vec3f> path;
  for (std::uint32_t i = 0; i <= segments; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(segments);
    path.push_back(from + t * (to - from) - Vec3f{0, 4.0f * sag * t * (1.0f - t), 0});
  }
  maker.add_tube(path, sides, [&](float) { return radius; });
}

}  // namespace workbench
