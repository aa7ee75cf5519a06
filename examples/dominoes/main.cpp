// A row of dominoes falls while a soft wheel bounces over it: four frames as one picture. The wheel bends, so
// its hierarchy is refitted; the dominoes are one box many times, so that a frame only builds the scene
// again.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <vector>

#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "../common/picture.hpp"
#include "../common/shapes.hpp"
#include "../common/vectors.hpp"

namespace {

constexpr unsigned dominoes = 16;
constexpr double thickness = 0.12, distance = 0.45;

// What stands in the scene, by `Instance::number`.
enum Kind : std::uint32_t { ground, wheel, domino };

// A box of half the size along each axis, outside outwards, on the plane z = 0.
shapes::Mesh make_box(float x, float y, float height) {
  shapes::Mesh box;
  for (unsigned i = 0; i < 8; ++i)
    box.vertices.push_back({i & 1 ? x : -x, i & 2 ? y : -y, i & 4 ? height : 0.0f});
  box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return box;
}

// Domino `i` turns about its lower edge in front, faster and faster, until it lies on the next one.
kerf::Transform fallen(unsigned i, double time) {
  const double since = std::max(0.0, time - 0.3 * i), angle = std::min(0.9 * since * since, 1.31);
  const double c = std::cos(angle), s = std::sin(angle), edge = 0.5 * thickness;
  return {{{c, 0, s, distance * i + edge - c * edge}, {0, 1, 0, 0}, {-s, 0, c, s * edge}}};
}

// The wheel's corners at a time: it turns, and is flat for a moment when it meets the dominoes.
std::vector<shapes::Point> bent(const shapes::Mesh& ring, double time) {
  const double c = std::cos(2.0 * time), s = std::sin(2.0 * time),
               flat = 1.0 - 0.35 * std::pow(std::cos(2.2 * time), 8.0);
  std::vector<shapes::Point> corners;
  for (const auto& [x, y, z] : ring.vertices) {
    const double across = c * x - s * y, up = s * x + c * y;
    corners.push_back({static_cast<float>(across / flat), z, static_cast<float>(flat * up)});
  }
  return corners;
}

// How many dominoes touch another one.
std::size_t count_touching(const kerf::Scene& scene) {
  std::set<std::uint32_t> touching;
  const auto is_domino = [&](std::uint32_t i) { return scene.instances()[i].number == domino; };
  for (const kerf::SceneTouchingPair& pair : scene.touching_pairs()) {
    if (is_domino(pair.first.instance) && is_domino(pair.second.instance))
      touching.insert({pair.first.instance, pair.second.instance});
  }
  return touching.size();
}

void draw(const kerf::Scene& scene, Picture& picture, std::size_t left, std::size_t top) {
  const Vec3f eye{3.0f, -9.0f, 4.2f}, sun = unit({-0.5f, -0.6f, 1.0f});
  for (std::size_t y = 0; y < picture.height / 2; ++y) {
    for (std::size_t x = 0; x < picture.width / 2; ++x) {
      const kerf::Ray ray{.origin = eye,
                          .direction = {(static_cast<float>(x) - 159.5f) / 330.0f, 1.0f,
                                        (75.5f - static_cast<float>(y)) / 330.0f - 0.3f}};
      const auto hit = scene.intersect(ray);
      if (!hit) {
        picture.set(left + x, top + y, 0.35f, 0.5f, 0.7f);
        continue;
      }
      const kerf::Instance& instance = scene.instances()[hit->instance];
      const kerf::HitGeometry at = scene.geometry(ray, *hit);
      const Vec3f normal = at.front ? at.normal : -1.0f * at.normal;
      const Vec3f from = ray.origin + hit->t * ray.direction + 1e-3f * normal;
      const bool dark = scene.occluded({.origin = from, .direction = sun});
      const float light = 0.18f + (dark ? 0.0f : 0.7f * std::max(0.0f, dot(normal, sun)));
      const Vec3f colour = instance.number == ground  ? Vec3f{0.55f, 0.55f, 0.5f}
                           : instance.number == wheel ? Vec3f{1.0f, 0.45f, 0.15f}
                                                      : Vec3f{0.2f, 0.45f, 0.9f};
      picture.set(left + x, top + y, light * colour.x, light * colour.y, light * colour.z);
    }
  }
}

}  // namespace

int main() {
  const shapes::Mesh ring = shapes::make_ring(120, 48),
                     box = make_box(static_cast<float>(0.5 * thickness), 0.3f, 1.0f),
                     plane = shapes::make_floor(40, 0);
  const auto built = [](const shapes::Mesh& mesh) {
    return kerf::build({.vertices = mesh.vertices, .triangles = mesh.triangles});
  };
  const kerf::Bvh of_box = built(box), of_plane = built(plane);
  kerf::Bvh of_ring = built(ring);

  Picture picture(640, 400);
  for (unsigned frame = 0; frame < 4; ++frame) {
    const double time = 1.25 * frame;
    // No scene shares the wheel at this moment, so that it is refitted in place.
    const std::vector<shapes::Point> corners = bent(ring, time);
    const kerf::RefitReport report =
        kerf::refit(of_ring, kerf::TriangleMesh{.vertices = corners, .triangles = ring.triangles});

    std::vector<kerf::Instance> instances{
        {.object = of_plane, .number = ground},
        {.object = of_ring,
         .transform = {{{0.6, 0, 0, 1.6 * time - 0.6},
                        {0, 0.6, 0, 0.2},
                        {0, 0, 0.6, 1.9 + 0.9 * std::abs(std::sin(2.2 * time))}}},
         .number = wheel}};
    for (unsigned i = 0; i < dominoes; ++i)
      instances.push_back({.object = of_box, .transform = fallen(i, time), .number = domino});
    const kerf::Scene scene = kerf::build(instances);
    std::printf("frame %u: %zu of %u dominoes touch; wheel %s\n", frame, count_touching(scene), dominoes,
                report.rebuilt ? "rebuilt" : "refitted");
    draw(scene, picture, frame % 2 * 320, frame / 2 * 200);
  }
  return picture.save("dominoes.ppm") ? 0 : 1;
}
