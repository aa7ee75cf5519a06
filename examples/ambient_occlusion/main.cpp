// How much of the sky each vertex sees, as it is baked into vertex colours: a span of rays in one call.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

#include <kerf/kerf.hpp>

#include "../common/picture.hpp"
#include "../common/shapes.hpp"
#include "../common/vectors.hpp"

namespace {

constexpr unsigned rays_per_vertex = 64;

// The sum of the normals of the triangles around each vertex, longer ones counting for more.
std::vector<Vec3f> vertex_normals(const shapes::Mesh& mesh) {
  std::vector<Vec3f> normals(mesh.vertices.size());
  const auto at = [&](unsigned i) { return kerf::to_vec3f(mesh.vertices[i]); };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3f normal = cross(at(b) - at(a), at(c) - at(a));
    for (const unsigned i : {a, b, c}) normals[i] = normals[i] + normal;
  }
  for (Vec3f& normal : normals) normal = unit(normal);
  return normals;
}

}  // namespace

int main() {
  constexpr unsigned rows = 160, columns = 64;
  const shapes::Mesh ring = shapes::make_ring(rows, columns);
  const kerf::Bvh bvh = kerf::build({.vertices = ring.vertices, .triangles = ring.triangles});

  std::vector<kerf::Ray> rays;
  const std::vector<Vec3f> normals = vertex_normals(ring);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3f n = normals[i], side = unit(std::abs(n.z) < 0.9f ? cross(n, {0, 0, 1}) : cross(n, {1, 0, 0}));
    const Vec3f other = cross(n, side), origin = kerf::to_vec3f(ring.vertices[i]) + 1e-3f * n;
    for (unsigned k = 0; k < rays_per_vertex; ++k) {  // evenly over the hemisphere: a spiral of equal areas
      const float z = (static_cast<float>(k) + 0.5f) / rays_per_vertex, r = std::sqrt(1.0f - z * z);
      const float angle = 2.399963f * static_cast<float>(k);
      rays.push_back(
          {.origin = origin, .direction = r * std::cos(angle) * side + r * std::sin(angle) * other + z * n});
    }
  }
  std::vector<std::uint8_t> hidden(rays.size());
  bvh.occluded(rays, hidden);

  // The tube unrolled: along the ring from left to right, around the tube from top to bottom.
  Picture picture(2 * rows, 3 * columns);
  float sum = 0.0f, darkest = 1.0f;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    unsigned open = 0;
    for (unsigned k = 0; k < rays_per_vertex; ++k) open += hidden[i * rays_per_vertex + k] == 0;
    const float light = static_cast<float>(open) / rays_per_vertex;
    sum += light;
    darkest = std::min(darkest, light);
    for (std::size_t y = 0; y < 3; ++y) {
      for (std::size_t x = 0; x < 2; ++x)
        picture.set(i / columns * 2 + x, i % columns * 3 + y, light * light, light * light, light * light);
    }
  }
  if (!picture.save("ambient_occlusion.ppm")) return 1;
  std::printf("ambient_occlusion.ppm: vertices see %.2f of the sky, the darkest %.2f\n",
              sum / static_cast<float>(normals.size()), darkest);
}
