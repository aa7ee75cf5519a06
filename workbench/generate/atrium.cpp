// A two-storeyed court with arcades round it: walls, floors and mouldings of a few triangles as long as the
// building, beside columns, arches and ornaments of thousands of small ones. The scene that spatial splits
// were made for.
#include <cmath>

#include "workbench/generate/generate.hpp"
#include "workbench/generate/ornaments.hpp"
#include "workbench/sampling/angles.hpp"

namespace workbench {
namespace {

using namespace kerf;

constexpr float bay = 3.6f;  // from column to column
constexpr int long_bays = 8, short_bays = 4;
constexpr float court_x = 0.5f * bay * long_bays, court_z = 0.5f * bay * short_bays;  // half the court
constexpr float aisle = 4.4f;    // from the columns to the outer wall
constexpr float gallery = 7.0f;  // floor of the upper storey
constexpr float eaves = 12.6f, top = 15.0f;

// One side of the court. `along` points from its first corner to its last, `out` from the court into the
// aisle.
struct Side {
  Vec3f corner, along, out;
  int bays;

  Vec3f at(float a, float y, float o) const { return corner + a * along + Vec3f{0, y, 0} + o * out; }
  float length() const { return bay * static_cast<float>(bays); }
};

constexpr Side sides[] = {{{-court_x, 0, court_z}, {1, 0, 0}, {0, 0, 1}, long_bays},
                          {{court_x, 0, court_z}, {0, 0, -1}, {1, 0, 0}, short_bays},
                          {{court_x, 0, -court_z}, {-1, 0, 0}, {0, 0, -1}, long_bays},
                          {{-court_x, 0, -court_z}, {0, 0, 1}, {-1, 0, 0}, short_bays}};

struct Storey {
  float floor, column_height, column_radius, wall_top;

  float springing() const { return floor + column_height; }
};

constexpr Storey ground{0.3f, 4.1f, 0.30f, 6.7f};
constexpr Storey upper{gallery, 2.9f, 0.20f, eaves};

// The wall over one arch: its two faces as fans from the upper corners to the curve, as modellers make them.
void add_arch(MeshMaker& maker, const Side& side, const Storey& storey, float begin, const Fineness& fine) {
  constexpr float half_wall = 0.3f;
  const float half_open = 0.5f * bay - 1.5f * storey.column_radius;
  const float middle = begin + 0.5f * bay;
  const auto on_arch = [&](double turns, float radius, float o) {
    const auto [sine, cosine] = sine_cosine(turns);
    return side.at(middle - radius * cosine, storey.springing() + 1.1f * radius * sine, o);
  };
  const std::uint32_t half_segments = fine(10, 2), segments = 2 * half_segments;
  for (const float o : {-half_wall, half_wall}) {
    const auto face = [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
      o < 0 ? maker.add_triangle(a, c, b) : maker.add_triangle(a, b, c);
    };
    const Vec3f upper_left = side.at(begin, storey.wall_top, o);
    const Vec3f upper_right = side.at(begin + bay, storey.wall_top, o);
    const Vec3f crown = on_arch(0.25, half_open, o);
    for (std::uint32_t i = 0; i < half_segments; ++i) {
      const double t0 = 0.5 * i / segments, t1 = 0.5 * (i + 1) / segments;
      face(on_arch(t0, half_open, o), on_arch(t1, half_open, o), upper_left);
      face(on_arch(0.5 - t1, half_open, o), on_arch(0.5 - t0, half_open, o), upper_right);
    }
    face(crown, upper_right, upper_left);
    face(side.at(begin, storey.springing(), o), on_arch(0.0, half_open, o), upper_left);
    face(on_arch(0.5, half_open, o), side.at(begin + bay, storey.springing(), o), upper_right);
  }
  maker.add_grid(segments, 1, [&](float u, float v) {  // the soffit
    return on_arch(0.5 * static_cast<double>(u), half_open, half_wall * (2.0f * v - 1.0f));
  });
  // The archivolt: a moulding along the arch, on the court's face of the wall.
  maker.add_grid(2 * segments, fine(8, 2), [&](float u, float v) {
    const float waves = 0.5f - 0.5f * sine_cosine(2.5 * static_cast<double>(v)).cosine;
    const float ends = std::min({1.0f, 6.0f * v, 6.0f * (1.0f - v)});
    return on_arch(0.5 - 0.5 * static_cast<double>(u), half_open + 0.26f * v,
                   -half_wall - ends * (0.05f + 0.06f * waves));
  });
}

// A string course or a cornice: a profile swept round the court in pieces as long as a side, mitred at the
// corners.
void add_cornice(MeshMaker& maker, float y, float height, float depth, const Fineness& fine) {
  for (const Side& side : sides) {
    maker.add_grid(1, fine(14, 3), [&](float u, float v) {
      const float step = 0.5f - 0.5f * sine_cosine(0.5 * static_cast<double>(v)).cosine;
      const float o = 0.3f + depth * (step + 0.12f * sine_cosine(3.0 * static_cast<double>(v)).sine);
      return side.at(o + (1.0f - u) * (side.length() - 2.0f * o), y + v * height, -o);
    });
    maker.add_quad(side.at(0, y + height, 0), side.at(side.length(), y + height, 0),
                   side.at(side.length() - 0.3f - depth, y + height, -0.3f - depth),
                   side.at(0.3f + depth, y + height, -0.3f - depth));
    const std::uint32_t dentils = static_cast<std::uint32_t>(side.bays) * std::min(fine(10, 1), 10u);
    const float width = side.length() / static_cast<float>(dentils);
    for (std::uint32_t i = 0; i < dentils; ++i) {
      const float a = (static_cast<float>(i) + 0.3f) * width;
      maker.add_box(side.at(a, y - 0.16f, -0.46f), 0.4f * width * side.along, {0, 0.16f, 0}, 0.2f * side.out);
    }
  }
}

// The groin vault over one bay of the lower aisle: two crossing half-barrels, of which the higher is visible.
void add_vault(MeshMaker& maker, const Side& side, float begin, float width, const Fineness& fine) {
  const auto barrel = [](float t) {
    return std::sqrt(std::max(0.0f, 1.0f - (2.0f * t - 1.0f) * (2.0f * t - 1.0f)));
  };
  const std::uint32_t squares = 2 * fine(7, 1);
  maker.add_grid(squares, squares, [&](float u, float v) {
    return side.at(begin + u * width, ground.springing() + 1.75f * std::max(barrel(u), barrel(v)), v * aisle);
  });
}

void add_balustrade(MeshMaker& maker, const Side& side, float begin, const Fineness& fine) {
  constexpr int balusters = 7;
  constexpr float room = bay - 2.0f * 0.3f;
  for (int i = 0; i < balusters; ++i) {
    const float a = begin + 0.3f + room * (static_cast<float>(i) + 0.5f) / balusters;
    add_baluster(maker, side.at(a, gallery + 0.1f, 0), 0.8f, fine);
  }
}

void add_side(MeshMaker& maker, const Side& side, const Fineness& fine) {
  for (int i = 0; i < side.bays; ++i) {
    const float begin = bay * static_cast<float>(i);
    add_column(maker, side.at(begin, ground.floor, 0), ground.column_height, ground.column_radius, fine);
    add_column(maker, side.at(begin, upper.floor, 0), upper.column_height, upper.column_radius, fine);
    add_arch(maker, side, ground, begin, fine);
    add_arch(maker, side, upper, begin, fine);
    add_vault(maker, side, begin, bay, fine);
    add_balustrade(maker, side, begin, fine);
    for (const Storey& storey : {ground, upper}) {  // on the spandrels, over each column
      add_rosette(maker, side.at(begin, storey.wall_top - 0.75f, -0.3f), -1.0f * side.along, {0, 1, 0}, 0.42f,
                  fine);
    }
    // A blind door in the outer wall.
    const Vec3f door = side.at(begin + 0.5f * bay - 0.7f, ground.floor, aisle - 0.2f);
    maker.add_box(door, 0.15f * side.along, {0, 2.6f, 0}, 0.2f * side.out);
    maker.add_box(door + 1.25f * side.along, 0.15f * side.along, {0, 2.6f, 0}, 0.2f * side.out);
    maker.add_box(door + Vec3f{0, 2.6f, 0} - 0.2f * side.along, 1.8f * side.along, {0, 0.25f, 0},
                  0.2f * side.out);
    // Rafters of the gallery, rising from the eaves to the outer wall.
    maker.add_box(side.at(begin - 0.1f, eaves - 0.5f, 0), 0.2f * side.along, {0, 0.3f, 0},
                  aisle * side.out + Vec3f{0, -0.9f, 0});
  }
  add_vault(maker, side, side.length(), aisle, fine);  // over the corner, seen along this side

  // The following shapes are as long as the side.
  const float l = side.length(), a0 = -aisle, a1 = l + aisle;
  maker.add_box(side.at(0, gallery + 0.9f, -0.12f), l * side.along, {0, 0.12f, 0},
                0.24f * side.out);  // handrail
  maker.add_box(side.at(0, gallery, -0.12f), l * side.along, {0, 0.1f, 0}, 0.24f * side.out);
  maker.add_box(side.at(-0.5f, 0, -0.5f), (l + 1.0f) * side.along, {0, 0.3f, 0},
                0.5f * side.out);  // the steps
  maker.add_box(side.at(0.2f, 0, -0.9f), (l - 0.4f) * side.along, {0, 0.15f, 0}, 0.4f * side.out);
  // Floors, ceiling and roof, mitred at the corners.
  maker.add_quad(side.at(a0, ground.floor, aisle), side.at(a1, ground.floor, aisle),
                 side.at(l, ground.floor, 0), side.at(0, ground.floor, 0));
  maker.add_quad(side.at(a0, gallery, aisle), side.at(a1, gallery, aisle), side.at(l + 0.3f, gallery, -0.3f),
                 side.at(-0.3f, gallery, -0.3f));
  for (const float lift : {0.0f, 0.3f}) {
    const Vec3f outer0 = side.at(a0, eaves - 1.1f + lift, aisle),
                outer1 = side.at(a1, eaves - 1.1f + lift, aisle);
    const Vec3f inner0 = side.at(0, eaves - 0.2f + lift, 0), inner1 = side.at(l, eaves - 0.2f + lift, 0);
    lift > 0.0f ? maker.add_quad(outer0, outer1, inner1, inner0)
                : maker.add_quad(inner0, inner1, outer1, outer0);
  }
  constexpr float thickness = 0.5f;  // of the outer wall
  maker.add_box(side.at(a0, 0, aisle), (l + 2.0f * aisle + thickness) * side.along, {0, eaves, 0},
                thickness * side.out);
  maker.add_box(side.at(a0, 0.3f, aisle - 0.06f), (l + 2.0f * aisle) * side.along, {0, 0.9f, 0},
                0.06f * side.out);
  maker.add_box(side.at(0, eaves, -0.3f), l * side.along, {0, top - eaves, 0},
                0.6f * side.out);  // the parapet
  maker.add_quad(side.at(l, ground.wall_top, -0.3f), side.at(0, ground.wall_top, -0.3f),
                 side.at(0, gallery, -0.3f), side.at(l, gallery, -0.3f));
}

void add_furniture(MeshMaker& maker, const Fineness& fine) {
  constexpr ProfilePoint fountain[] = {
      {2.60f, 0.00f}, {2.65f, 0.15f}, {2.45f, 0.25f}, {2.50f, 0.60f}, {2.70f, 0.72f}, {2.60f, 0.80f},
      {2.35f, 0.74f}, {2.30f, 0.40f}, {0.90f, 0.35f}, {0.50f, 0.50f}, {0.32f, 0.90f}, {0.28f, 1.50f},
      {0.50f, 1.80f}, {1.30f, 2.05f}, {1.42f, 2.20f}, {1.30f, 2.16f}, {0.50f, 2.00f}, {0.24f, 2.10f},
      {0.18f, 2.70f}, {0.35f, 3.00f}, {0.75f, 3.15f}, {0.70f, 3.20f}, {0.20f, 3.10f}, {0.14f, 3.40f},
      {0.24f, 3.62f}, {0.14f, 3.84f}, {0.03f, 3.90f}};
  add_turned(maker, {0, 0, 0}, fountain, 1.0f, fine(72, 6), fine(90, 20));
  for (const float x : {-10.5f, -5.5f, 5.5f, 10.5f}) {
    for (const float z : {-4.2f, 4.2f}) {
      maker.add_box({x - 0.35f, 0, z - 0.35f}, {x + 0.35f, 0.9f, z + 0.35f});
      add_vase(maker, {x, 0.9f, z}, 1.1f, fine);
    }
    // A lantern on two long chains across the court.
    const Vec3f lamp{x + 2.0f, 6.2f, 0};
    for (const float z : {-court_z, court_z}) {
      maker.add_bar({x + 2.0f, eaves - 0.8f, z}, lamp + Vec3f{0, 0.5f, 0}, 0.015f, 3);
    }
    add_ring(maker, lamp, {1, 0, 0}, {0, 0, -1}, 0.6f, 0.04f, fine(48), fine(8));
    add_ring(maker, lamp, {1, 0, 0}, {0, 1, 0}, 0.55f, 0.03f, fine(48), fine(8));
    add_ring(maker, lamp, {0, 0, 1}, {0, 1, 0}, 0.55f, 0.03f, fine(48), fine(8));
  }
  for (const Side& side : sides) {  // cloths over some balustrades
    for (int i = 1; i < side.bays; i += 3) {
      const float begin = bay * static_cast<float>(i);
      add_drape(maker, side.at(begin + 0.6f, gallery + 1.03f, -0.38f),
                side.at(begin + bay - 0.6f, gallery + 1.03f, -0.38f), 3.0f, 0.16f, 4, fine);
    }
  }
}

}  // namespace

Scene generate_atrium(double detail) {
  const Fineness fine(detail);
  MeshMaker maker;
  maker.add_quad({-court_x, 0, court_z}, {court_x, 0, court_z}, {court_x, 0, -court_z},
                 {-court_x, 0, -court_z});
  for (const Side& side : sides) add_side(maker, side, fine);
  add_cornice(maker, ground.wall_top - 0.1f, 0.35f, 0.25f, fine);
  add_cornice(maker, eaves - 0.2f, 0.6f, 0.5f, fine);
  add_furniture(maker, fine);

  Scene scene;
  scene.vertices = std::move(maker.vertices());
  scene.triangles = std::move(maker.triangles());
  scene.viewpoints = {
      {.position = {-13.2f, 2.2f, 3.4f}, .target = {4, 4.6f, -2.5f}, .vertical_field_of_view = 68},
      {.position = {-12.6f, 9.3f, 8.6f}, .target = {2, 6.2f, -4}, .vertical_field_of_view = 65},
      {.position = {-15.5f, 2.0f, court_z + 2.0f}, .target = {6, 2.7f, court_z + 1.0f}},
      {.position = {16, 9.0f, 9.2f}, .target = {-2, 8.7f, 8.6f}},
      {.position = {22, 36, 22}, .target = {-1, 4, -1}, .vertical_field_of_view = 45}};
  return scene;
}

}  // namespace workbench
