// Random long thin triangles in a ball, which boxes fit as badly as possible.
#include <cmath>

#include "workbench/generate/generate.hpp"
#include "workbench/generate/mesh_maker.hpp"
#include "workbench/sampling/random_direction.hpp"

namespace workbench {
namespace {

using namespace kerf;

constexpr double count = 60'000.0;  // at detail 1
constexpr float ball_radius = 10.0f;

Vec3f random_place(RandomNumbers& random) {
  for (;;) {
    const Vec3f p{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    if (dot(p, p) <= 1.0f) return ball_radius * p;
  }
}

}  // namespace

Scene generate_sticks(double detail) {
  const std::uint32_t sticks = scaled(count, detail, 1);
  RandomNumbers random(2009);
  MeshMaker maker;
  for (std::uint32_t i = 0; i < sticks; ++i) {
    const Vec3f middle = random_place(random);
    const Vec3f along = random_direction(random);
    const Vec3f across = normalize(cross(along, random_direction(random)));
    const float half_length = random.between(0.3f, 1.5f), half_width = random.between(0.004f, 0.02f);
    maker.add_triangle(middle - half_length * along - half_width * across,
                       middle - half_length * along + half_width * across, middle + half_length * along);
  }
  Scene scene;
  scene.vertices = std::move(maker.vertices());
  scene.triangles = std::move(maker.triangles());
  scene.viewpoints = {{.position = {0, 4, 26}, .target = {0, 0, 0}, .vertical_field_of_view = 50},
                      {.position = {0, 0, 0}, .target = {1, 0.2f, 0.3f}, .vertical_field_of_view = 75},
                      {.position = {-9, 7, -5}, .target = {2, -1, 1}},
                      {.position = {3, -2, 8}, .target = {-4, 1, -3}}};
  return scene;
}

}  // namespace workbench
