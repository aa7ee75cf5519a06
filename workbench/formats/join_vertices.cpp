#include "workbench/formats/join_vertices.hpp"

#include <bit>
#include <limits>

namespace workbench {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

std::uint64_t hash(const kerf::Vec3f& p) {
  const std::uint64_t xy =
      std::uint64_t{std::bit_cast<std::uint32_t>(p.x)} << 32 | std::bit_cast<std::uint32_t>(p.y);
  std::uint64_t h = (xy ^ std::uint64_t{std::bit_cast<std::uint32_t>(p.z)} * 0x9e3779b97f4a7c15u);
  // The finishing steps of common 64-bit mixers, which spread the high bits.
  h = (h ^ h >> 32) * 0xd6e8feb86659fd93u;
  h = (h ^ h >> 32) * 0xd6e8feb86659fd93u;
  return h ^ h >> 32;
}

bool same_bits(const kerf::Vec3f& a, const kerf::Vec3f& b) {
  return std::bit_cast<std::array<std::uint32_t, 3>>(a) == std::bit_cast<std::array<std::uint32_t, 3>>(b);
}

}  // namespace

void join_vertices(Scene& scene) {
  // An open-addressing table of the vertices that are kept, at most half full.
  std::vector<std::uint32_t> table(std::bit_ceil(2 * scene.vertices.size() + 1), none);
  const std::size_t mask = table.size() - 1;
  std::vector<std::uint32_t> kept_as(scene.vertices.size(), none);
  std::vector<kerf::Vec3f> kept;
  for (auto& triangle : scene.triangles) {
    for (std::uint32_t& vertex : triangle) {
      if (kept_as[vertex] == none) {
        const kerf::Vec3f& p = scene.vertices[vertex];
        std::size_t slot = hash(p) & mask;
        while (table[slot] != none && !same_bits(kept[table[slot]], p)) slot = (slot + 1) & mask;
        if (table[slot] == none) {
          table[slot] = static_cast<std::uint32_t>(kept.size());
          kept.push_back(p);
        }
        kept_as[vertex] = table[slot];
      }
      vertex = kept_as[vertex];
    }
  }
  scene.vertices = std::move(kept);
}

}  // namespace workbench
