// Streets of boxes on rolling ground, and cables from roof to roof: long thin triangles at every angle above
// tall upright ones. A larger `detail` makes a larger city.
#include <algorithm>
#include <cmath>

#include "workbench/generate/generate.hpp"
#include "workbench/generate/noise.hpp"
#include "workbench/generate/ornaments.hpp"
#include "workbench/sampling/angles.hpp"
#include "workbench/sampling/random.hpp"

namespace workbench {
namespace {

using namespace kerf;

constexpr double lots_per_side = 22.0;  // at detail 1
constexpr float lot = 36.0f;            // from street to street
constexpr std::uint32_t ground_squares_per_lot = 6;

float ground_at(float x, float z) {
  return 14.0f * fractal_noise(x / 260.0f, z / 260.0f, 4, 3);
}

// An upright box that may be turned about the vertical: a corner, two horizontal edges, and a height.
class Block {
 public:
  Block(const Vec3f& center, float width, float depth, double turns)
      : center_(center), width_(width), depth_(depth) {
    const auto [sine, cosine] = sine_cosine(turns);
    x_ = {cosine, 0, -sine};
    z_ = {sine, 0, cosine};
  }

  Vec3f at(float x, float y, float z) const {
    return center_ + (0.5f * width_ * x) * x_ + Vec3f{0, y, 0} + (0.5f * depth_ * z) * z_;
  }

  void add_slab(MeshMaker& maker, float low, float high, float overhang) const {
    const float w = width_ + 2.0f * overhang, d = depth_ + 2.0f * overhang;
    maker.add_box(center_ - 0.5f * w * x_ - 0.5f * d * z_ + Vec3f{0, low, 0}, w * x_, {0, high - low, 0},
                  d * z_);
  }

  // A bar on the face towards z (or x), `across` from -1 to 1.
  void add_pilaster(MeshMaker& maker, float across, float low, float high, bool on_x) const {
    constexpr float half_width = 0.25f, relief = 0.3f;
    for (const float face : {-1.0f, 1.0f}) {
      const Vec3f foot = on_x ? at(face, low, across) : at(across, low, face);
      maker.add_box(foot - half_width * x_ - relief * z_, 2.0f * half_width * x_, {0, high - low, 0},
                    2.0f * relief * z_);
    }
  }

 private:
  Vec3f center_, x_, z_;
  float width_, depth_;
};

// Returns the top, from which cables may hang.
Vec3f add_building(MeshMaker& maker, const Vec3f& foot, float central, RandomNumbers& random) {
  const double turns = random.uniform() < 0.25f ? static_cast<double>(random.uniform()) : 0.0;
  const float width = random.between(13, 24), depth = random.between(13, 24);
  constexpr float storey = 3.6f, cellar = 20.0f;
  auto storeys = static_cast<float>(3 + random.below(5));
  storeys += std::floor(22.0f * central * random.uniform());
  Block block(foot, width, depth, turns);
  block.add_slab(maker, -cellar, storeys * storey, 0.0f);
  for (float i = 1; i <= storeys; ++i) block.add_slab(maker, i * storey - 0.35f, i * storey, 0.35f);
  for (const float across : {-0.9f, -0.45f, 0.0f, 0.45f, 0.9f}) {
    block.add_pilaster(maker, across, 0, storeys * storey, false);
    block.add_pilaster(maker, across, 0, storeys * storey, true);
  }
  const float roof = storeys * storey;
  const Vec3f peak = block.at(0.3f, roof, -0.2f);
  Block(block.at(0.3f, roof, -0.2f), 0.4f * width, 0.35f * depth, turns).add_slab(maker, 0, 3.0f, 0.0f);
  for (int i = 0; i < 3; ++i) {  // antennas
    const float across = random.between(-0.8f, 0.8f), along = random.between(-0.8f, 0.8f);
    const Vec3f mast = block.at(across, roof, along);
    maker.add_bar(
        mast, mast + Vec3f{random.between(-0.6f, 0.6f), random.between(5, 14), random.between(-0.6f, 0.6f)},
        0.08f, 4);
  }
  if (random.uniform() < 0.3f) {  // a water tank with a cone on it
    constexpr ProfilePoint tank[] = {{0.0f, 0.0f}, {2.2f, 0.01f}, {2.2f, 3.6f}, {2.5f, 3.7f}, {0.02f, 5.2f}};
    maker.add_lathe(block.at(-0.5f, roof + 1.5f, 0.4f), std::span(tank).subspan(1), 16);
  }
  return peak + Vec3f{0, 3, 0};
}

}  // namespace

Scene generate_city(double detail) {
  const std::uint32_t side = scaled(lots_per_side, std::sqrt(detail), 2);
  const float half = 0.5f * lot * static_cast<float>(side);
  MeshMaker maker;
  const std::uint32_t squares = ground_squares_per_lot * side;
  maker.add_grid(squares, squares, [&](float u, float v) {
    const float x = (2.0f * u - 1.0f) * half, z = (1.0f - 2.0f * v) * half;
    return Vec3f{x, ground_at(x, z), z};
  });

  RandomNumbers random(1973);
  std::vector<Vec3f> roofs;  // row after row
  for (std::uint32_t row = 0; row < side; ++row) {
    for (std::uint32_t column = 0; column < side; ++column) {
      const float x = (static_cast<float>(column) + 0.5f) * lot - half;
      const float z = (static_cast<float>(row) + 0.5f) * lot - half;
      const float distance = std::sqrt(x * x + z * z) / 300.0f;
      const float central = 1.0f / (1.0f + distance * distance * distance);
      roofs.push_back(add_building(maker, {x, ground_at(x, z), z}, central, random));
    }
  }
  // A few cables go from each roof to a roof some lots away.
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const std::uint32_t row = i / side, column = i % side;
    const std::uint32_t other_row = std::min(side - 1, row + random.below(4));
    const std::uint32_t other_column = std::min(side - 1, column + random.below(4));
    const Vec3f &from = roofs[i], &to = roofs[other_row * side + other_column];
    if (other_row == row && other_column == column) continue;
    for (const float offset : {-1.5f, 0.0f, 1.5f}) {
      add_cable(maker, from + Vec3f{offset, 0, -offset}, to + Vec3f{offset, 0, -offset},
                0.05f * length(to - from), 0.06f, 6, 3);
    }
  }

  Scene scene;
  scene.vertices = std::move(maker.vertices());
  scene.triangles = std::move(maker.triangles());
  const auto above_ground = [](float x, float z, float y) { return Vec3f{x, ground_at(x, z) + y, z}; };
  scene.viewpoints = {
      {.position = above_ground(0, 140, 5), .target = above_ground(0, -60, 28), .vertical_field_of_view = 70},
      {.position = above_ground(330, 300, 110), .target = {-20, 20, -30}, .vertical_field_of_view = 55},
      {.position = above_ground(-72, -74, 75),
       .target = above_ground(120, 160, 0),
       .vertical_field_of_view = 65},
      {.position = above_ground(-144, 36, 3),
       .target = above_ground(40, 36, 20),
       .vertical_field_of_view = 65}};
  return scene;
}

}  // namespace workbench
