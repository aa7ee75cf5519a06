// A large meeting room: walls and ceiling of a few triangles, and in it tables, chairs with thin slanted
// legs, tilted slats and trusses: long narrow triangles along no axis.
#include <cmath>

#include "workbench/generate/generate.hpp"
#include "workbench/generate/ornaments.hpp"
#include "workbench/sampling/angles.hpp"
#include "workbench/sampling/random.hpp"

namespace workbench {
namespace {

using namespace kerf;

constexpr float room_x = 9.0f, room_z = 7.0f, room_y = 4.6f;  // half the length, half the depth, the height

// The frame of a piece of furniture, x to its right and z behind it: turned about the vertical and moved.
struct Place {
  Vec3f origin, x, z;

  Place(const Vec3f& at, double turns) : origin(at) {
    const auto [sine, cosine] = sine_cosine(turns);
    x = {cosine, 0, -sine};
    z = {sine, 0, cosine};
  }
  Vec3f at(float a, float y, float b) const { return origin + a * x + Vec3f{0, y, 0} + b * z; }
};

void add_chair(MeshMaker& maker, const Place& place, const Fineness& fine) {
  const std::uint32_t round = fine(6);
  for (const float side : {-1.0f, 1.0f}) {
    maker.add_bar(place.at(0.27f * side, 0, -0.27f), place.at(0.19f * side, 0.45f, -0.19f), 0.012f, round);
    const std::array back_leg{place.at(0.27f * side, 0, 0.32f), place.at(0.2f * side, 0.45f, 0.2f),
                              place.at(0.2f * side, 0.7f, 0.25f), place.at(0.19f * side, 1.0f, 0.34f)};
    maker.add_tube(back_leg, round, [](float) { return 0.012f; });
    const std::array arm{place.at(0.2f * side, 0.45f, -0.18f), place.at(0.27f * side, 0.55f, -0.2f),
                         place.at(0.28f * side, 0.66f, -0.14f), place.at(0.27f * side, 0.68f, 0.1f),
                         place.at(0.2f * side, 0.68f, 0.25f)};
    maker.add_tube(arm, round, [](float) { return 0.014f; });
    maker.add_bar(place.at(0.25f * side, 0.12f, -0.25f), place.at(0.25f * side, 0.12f, 0.29f), 0.008f, round);
  }
  maker.add_bar(place.at(-0.25f, 0.12f, 0.02f), place.at(0.25f, 0.12f, 0.02f), 0.008f, round);
  // Two cushions, closed all round: the surface of a rounded slab.
  const auto cushion = [&](float width, float depth, auto&& lay) {
    maker.add_grid(4 * fine(4, 1), fine(8, 2), [&](float u, float v) {
      const auto [sine, cosine] = sine_cosine(u);
      const auto [rise, reach] = sine_cosine(0.5 * static_cast<double>(v) - 0.25);
      const float square = 1.0f / std::max(std::abs(sine), std::abs(cosine));
      const float r =
          (0.02f + 0.33f * std::min(1.0f, 8.0f * reach) + 0.65f * std::sqrt(std::max(0.0f, reach))) *
          (0.75f + 0.25f * square);
      return lay(width * r * cosine, -depth * r * sine, rise);
    });
  };
  cushion(0.22f, 0.22f, [&](float a, float b, float rise) {
    return place.at(a, 0.47f + 0.025f * rise + 0.25f * b * b, b);
  });
  cushion(0.2f, 0.19f, [&](float a, float b, float rise) {
    return place.at(a, 0.8f - b, 0.27f + 0.02f * rise - 0.25f * b + 0.5f * a * a);
  });
}

void add_cup(MeshMaker& maker, const Vec3f& foot, const Fineness& fine) {
  constexpr ProfilePoint cup[] = {{0.002f, 0.004f}, {0.025f, 0.0f},  {0.028f, 0.01f}, {0.038f, 0.05f},
                                  {0.04f, 0.09f},   {0.037f, 0.09f}, {0.034f, 0.05f}, {0.002f, 0.012f}};
  add_turned(maker, foot, cup, 1.0f, fine(16), fine(10, 3));
}

void add_microphone(MeshMaker& maker, const Place& place, const Fineness& fine) {
  maker.add_box(place.at(-0.05f, 0, -0.04f), 0.1f * place.x, {0, 0.02f, 0}, 0.08f * place.z);
  const std::array neck{place.at(0, 0.02f, 0), place.at(0, 0.2f, 0.02f), place.at(0, 0.32f, 0.08f),
                        place.at(0, 0.38f, 0.18f)};
  maker.add_tube(neck, fine(5), [](float t) { return t < 1.0f ? 0.005f : 0.012f; });
}

// A table with four thin splayed legs, a rail under its edge, and chairs on its far side.
void add_table(MeshMaker& maker, const Place& place, float table_length, RandomNumbers& random,
               const Fineness& fine) {
  constexpr float half_depth = 0.4f, table_height = 0.74f;
  const float half = 0.5f * table_length;
  maker.add_box(place.at(-half, table_height - 0.03f, -half_depth), table_length * place.x, {0, 0.03f, 0},
                2.0f * half_depth * place.z);
  maker.add_bar(place.at(-half + 0.1f, table_height - 0.1f, -0.3f),
                place.at(half - 0.1f, table_height - 0.1f, -0.3f), 0.015f, fine(6));
  maker.add_bar(place.at(-half + 0.1f, table_height - 0.1f, 0.3f),
                place.at(half - 0.1f, table_height - 0.1f, 0.3f), 0.015f, fine(6));
  for (const float a : {-1.0f, 1.0f}) {
    for (const float b : {-1.0f, 1.0f}) {
      maker.add_bar(place.at(a * (half - 0.02f), 0, b * (half_depth + 0.03f)),
                    place.at(a * (half - 0.15f), table_height - 0.03f, b * (half_depth - 0.1f)), 0.018f,
                    fine(6));
    }
  }
  const auto chairs = static_cast<int>(table_length / 0.8f);
  for (int i = 0; i < chairs; ++i) {
    const float a = -half + table_length * (static_cast<float>(i) + 0.5f) / static_cast<float>(chairs);
    Place chair = place;
    const float beside = random.between(-0.06f, 0.06f), behind = random.between(-0.06f, 0.12f);
    chair.origin = place.at(a + beside, 0, 0.75f + behind);
    const auto [sine, cosine] = sine_cosine(random.between(-0.08f, 0.08f));
    chair.x = cosine * place.x - sine * place.z;
    chair.z = sine * place.x + cosine * place.z;
    add_chair(maker, chair, fine);
    Place on_table = chair;
    on_table.origin = place.at(a + 0.1f, table_height, -0.12f);
    add_microphone(maker, on_table, fine);
    add_cup(maker, place.at(a - 0.22f, table_height, 0.02f), fine);
    // A few sheets of paper, each turned a little: large thin boxes on top of each other.
    for (int sheet = 0; sheet < 3; ++sheet) {
      const auto [s, c] = sine_cosine(random.between(-0.05f, 0.05f));
      maker.add_box(place.at(a - 0.1f, table_height + 0.002f * static_cast<float>(sheet), 0.06f),
                    0.21f * (c * place.x - s * place.z), {0, 0.001f, 0},
                    0.297f * (s * place.x + c * place.z));
    }
  }
}

void add_room(MeshMaker& maker, const Fineness& fine) {
  const float x = room_x, y = room_y, z = room_z;
  maker.add_quad({-x, 0, z}, {x, 0, z}, {x, 0, -z}, {-x, 0, -z});
  maker.add_quad({-x, y, -z}, {x, y, -z}, {x, y, z}, {-x, y, z});
  maker.add_quad({-x, 0, -z}, {x, 0, -z}, {x, y, -z}, {-x, y, -z});
  maker.add_quad({x, 0, z}, {-x, 0, z}, {-x, y, z}, {x, y, z});
  maker.add_quad({-x, 0, z}, {-x, 0, -z}, {-x, y, -z}, {-x, y, z});
  maker.add_quad({x, 0, -z}, {x, 0, z}, {x, y, z}, {x, y, -z});
  maker.add_box({-x, 0, -z}, {x, 0.12f, -z + 0.03f});  // skirting boards
  maker.add_box({-x, 0, z - 0.03f}, {x, 0.12f, z});
  maker.add_box({-x, 3.1f, -z}, {x, 3.2f, -z + 0.12f});  // a rail with curtains below it
  for (float a = -x + 0.4f; a < x - 2.0f; a += 4.3f) {
    add_drape(maker, {a, 3.1f, -z + 0.14f}, {a + 1.3f, 3.1f, -z + 0.14f}, 2.9f, 0.07f, 6, fine);
  }
  // Blinds on the two short walls: slats, all tilted alike, and their cords.
  for (const float wall : {-1.0f, 1.0f}) {
    for (int window = -1; window <= 1; ++window) {
      const float from = 4.6f * static_cast<float>(window) - 2.0f;
      for (int slat = 0; slat < 36; ++slat) {
        maker.add_box({wall * (x - 0.1f) - 0.03f, 1.0f + 0.06f * static_cast<float>(slat), from},
                      {0.045f, 0.035f, 0}, {-0.0015f, 0.002f, 0}, {0, 0, 4.0f});
      }
      for (const float cord : {0.3f, 2.0f, 3.7f}) {
        maker.add_bar({wall * (x - 0.1f), 0.95f, from + cord}, {wall * (x - 0.1f), 3.2f, from + cord}, 0.004f,
                      3);
      }
    }
  }
  add_turned(maker, {-8.2f, 0, 6.2f},
             std::array<ProfilePoint, 6>{
                 {{0.3f, 0}, {0.34f, 0.1f}, {0.25f, 0.2f}, {0.3f, 0.5f}, {0.4f, 0.75f}, {0.36f, 0.8f}}},
             1.0f, fine(32), fine(16));
}

// A lattice girder along z under the ceiling: four chords and the diagonals between them.
void add_truss(MeshMaker& maker, float x, const Fineness& fine) {
  constexpr float low = 3.9f, high = 4.4f, half_width = 0.25f, panel = 0.64f;
  const std::uint32_t round = fine(5);
  for (const float side : {-half_width, half_width}) {
    maker.add_bar({x + side, low, -room_z}, {x + side, low, room_z}, 0.03f, round);
    maker.add_bar({x + side, high, -room_z}, {x + side, high, room_z}, 0.03f, round);
    for (float z = -room_z; z < room_z - 0.5f * panel; z += panel) {
      maker.add_bar({x + side, low, z}, {x + side, high, z + 0.5f * panel}, 0.015f, round);
      maker.add_bar({x + side, high, z + 0.5f * panel}, {x + side, low, z + panel}, 0.015f, round);
      maker.add_bar({x + side, low, z}, {x - side, low, z + panel}, 0.01f, round);
    }
  }
}

void add_lamp(MeshMaker& maker, const Vec3f& at, const Fineness& fine) {
  constexpr ProfilePoint shade[] = {{0.02f, 0.28f}, {0.07f, 0.24f}, {0.19f, 0.15f},
                                    {0.33f, 0.01f}, {0.35f, 0.0f},  {0.34f, 0.02f},
                                    {0.20f, 0.16f}, {0.08f, 0.26f}, {0.04f, 0.30f}};
  add_turned(maker, at, shade, 1.0f, fine(28), fine(14));
  for (const double turns : {0.1, 0.43, 0.77}) {
    const auto [sine, cosine] = sine_cosine(turns);
    maker.add_bar(at + Vec3f{0.3f * cosine, 0.05f, 0.3f * sine}, {at.x, 3.9f, at.z}, 0.004f, 3);
  }
}

}  // namespace

Scene generate_conference(double detail) {
  const Fineness fine(detail);
  RandomNumbers random(1992);
  MeshMaker maker;
  add_room(maker, fine);
  for (float x = -7.5f; x <= 7.6f; x += 2.5f) add_truss(maker, x, fine);
  // Tables stand in arcs round the speaker's end of the room. The gaps of an arc are behind the tables of the
  // arc before it.
  constexpr Vec3f speaker{-7.6f, 0, 0};
  constexpr float table_length = 2.6f, gap = 0.5f;
  for (int arc = 0; arc < 7; ++arc) {
    const float radius = 3.4f + 1.75f * static_cast<float>(arc);
    for (float i = arc % 2 == 0 ? -4.0f : -4.5f; i <= 4.5f; ++i) {
      const double turns = 0.15915494 * static_cast<double>(i * (table_length + gap) / radius);
      const auto [sine, cosine] = sine_cosine(turns);
      const Vec3f at = speaker + Vec3f{radius * cosine, 0, radius * sine};
      if (std::abs(turns) > 0.2 || std::abs(at.z) > room_z - 1.4f || at.x > room_x - 1.4f) continue;
      add_table(maker, Place(at, 0.25 - turns), table_length, random, fine);
    }
  }
  add_table(maker, Place(speaker + Vec3f{1.0f, 0, 0}, -0.25), 3.2f, random, fine);
  for (const float x : {-5.0f, -2.5f, 0.0f, 2.5f, 5.0f}) {
    for (const float z : {-4.5f, -1.5f, 1.5f, 4.5f}) add_lamp(maker, {x, 2.9f, z}, fine);
  }

  Scene scene;
  scene.vertices = std::move(maker.vertices());
  scene.triangles = std::move(maker.triangles());
  scene.viewpoints = {
      {.position = {8.2f, 2.3f, 6.2f}, .target = {-2, 0.7f, -1.5f}, .vertical_field_of_view = 65},
      {.position = {-8.2f, 1.7f, 0.8f}, .target = {3, 0.6f, -0.2f}, .vertical_field_of_view = 65},
      {.position = {8.3f, 0.3f, -3.6f}, .target = {-2, 0.55f, 1.5f}},
      {.position = {-8.6f, 3.6f, -6.5f}, .target = {2, 1.2f, 2.5f}, .vertical_field_of_view = 70}};
  return scene;
}

}  // namespace workbench
