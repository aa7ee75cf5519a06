// Long thin strands that curl out of a ball, and overlap each other everywhere.
#include <cmath>

#include "workbench/generate/generate.hpp"
#include "workbench/generate/mesh_maker.hpp"
#include "workbench/sampling/random_direction.hpp"

namespace workbench {
namespace {

using namespace kerf;

constexpr double strands = 1800.0;  // at detail 1
constexpr std::uint32_t segments = 24, tube_sides = 3;
constexpr float core_radius = 1.0f;

// A strand leaves the core at a random point, turns steadily about an axis of its own, and is drawn back to
// the ball.
void add_strand(MeshMaker& maker, RandomNumbers& random) {
  Vec3f at = core_radius * random_direction(random);
  Vec3f direction = normalize(normalize(at) + 0.9f * random_direction(random));
  const Vec3f axis = random_direction(random);
  const float curl = random.between(0.05f, 0.28f), step = random.between(0.1f, 0.2f);
  const float thickness = random.between(0.004f, 0.009f);
  std::vector<Vec3f> path;
  for (std::uint32_t i = 0; i <= segments; ++i) {
    path.push_back(at);
    at = at + step * direction;
    const float outside = std::max(0.0f, length(at) - 2.0f * core_radius);
    direction = normalize(direction + curl * cross(axis, direction) - (0.25f * outside) * normalize(at) +
                          0.12f * random_direction(random));
  }
  maker.add_tube(path, tube_sides, [&](float t) { return thickness * (1.0f - 0.8f * t * t); });
}

}  // namespace

Scene generate_hairball(double detail) {
  RandomNumbers random(1948);
  MeshMaker maker;
  for (std::uint32_t i = 0; i < scaled(strands, detail, 1); ++i) add_strand(maker, random);
  Scene scene;
  scene.vertices = std::move(maker.vertices());
  scene.triangles = std::move(maker.triangles());
  scene.viewpoints = {{.position = {0, 1.5f, 7}, .target = {0, 0, 0}, .vertical_field_of_view = 45},
                      {.position = {-2.2f, 1.2f, 1.8f}, .target = {0, 0, 0}, .vertical_field_of_view = 65},
                      {.position = {0.1f, 0.1f, 0.2f}, .target = {1, 0.4f, -1}, .vertical_field_of_view = 80},
                      {.position = {1.2f, -1.9f, -1.6f}, .target = {-0.6f, 0.4f, 0.2f}}};
  return scene;
}

}  // namespace workbench
