// A lidar turns on its mast above hilly ground and a row of posts: many rays in one call, and what it sees as
// characters, near ones dark.
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <kerf/kerf.hpp>

namespace {

constexpr int ground_cells = 200;  // along each side; a cell is one metre
constexpr int columns = 100, rows = 24;

using Point = std::array<float, 3>;
using Triangle = std::array<unsigned, 3>;

float height(float x, float y) {
  return 2.0f * std::sin(0.11f * x) * std::cos(0.07f * y) + 0.3f * std::sin(0.9f * x + y);
}

struct Mesh {
  std::vector<Point> vertices;
  std::vector<Triangle> triangles;
};

Mesh make_ground() {
  Mesh mesh;
  for (int j = 0; j <= ground_cells; ++j) {
    for (int i = 0; i <= ground_cells; ++i) {
      const auto x = static_cast<float>(i - ground_cells / 2), y = static_cast<float>(j - ground_cells / 2);
      mesh.vertices.push_back({x, y, height(x, y)});
    }
  }
  constexpr unsigned width = ground_cells + 1;
  for (unsigned j = 0; j + 1 < width; ++j) {
    for (unsigned i = 0; i + 1 < width; ++i) {
      const unsigned v = j * width + i;
      mesh.triangles.push_back({v, v + 1, v + width + 1});
      mesh.triangles.push_back({v, v + width + 1, v + width});
    }
  }
  return mesh;
}

// A flat board, four metres high and half a metre wide, in front of every eighth column.
Mesh make_posts() {
  Mesh mesh;
  for (int i = 0; i < columns; i += 8) {
    const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / columns;
    const float x = 15.0f * std::cos(angle), y = 15.0f * std::sin(angle), z = height(x, y);
    const float dx = -0.25f * std::sin(angle), dy = 0.25f * std::cos(angle);
    const auto first = static_cast<unsigned>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {Point{x - dx, y - dy, z}, Point{x + dx, y + dy, z},
                                               Point{x + dx, y + dy, z + 4}, Point{x - dx, y - dy, z + 4}});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

}  // namespace

int main() {
  const Mesh ground = make_ground(), posts = make_posts();
  const kerf::TriangleMesh meshes[] = {{.vertices = ground.vertices, .triangles = ground.triangles},
                                       {.vertices = posts.vertices, .triangles = posts.triangles}};
  const kerf::Bvh bvh = kerf::build(meshes);

  const kerf::Vec3f sensor{0.0f, 0.0f, height(0, 0) + 2.5f};
  constexpr float range = 80.0f;
  std::vector<kerf::Ray> rays;
  for (int row = 0; row < rows; ++row) {
    const float up = 0.15f - 0.55f * static_cast<float>(row) / rows;  // radians above the horizon
    for (int column = 0; column < columns; ++column) {
      const float turn = 2.0f * std::numbers::pi_v<float> * static_cast<float>(column) / columns;
      rays.push_back(
          {.origin = sensor,
           .direction = {std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up)},
           .t_max = range});
    }
  }
  std::vector<kerf::Hit> hits(rays.size());
  bvh.intersect(rays, hits);  // on all cores

  for (std::size_t i = 0; i < hits.size(); ++i) {
    constexpr char shades[] = "#%*+=-:.";
    const kerf::Hit& hit = hits[i];
    // Distances on a logarithmic scale, from 5 m to the range; directions have length 1, so that t is in
    // metres.
    const auto shade = [&] {
      const float far = std::log(hit.t / 5.0f) / std::log(range / 5.0f);
      return far <= 0.0f ? 0 : static_cast<int>(far * 7.99f);
    };
    std::putchar(!hit ? ' ' : hit.mesh == 1 ? 'I' : shades[shade()]);
    if (i % columns == columns - 1) std::putchar('\n');
  }
}
