#include "workbench/formats/join_vertices.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

namespace workbench {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t min_slots = 1024;

/// Positions whose slots are fetched from memory while those before them are looked up.
constexpr std::size_t positions_ahead = 24;

std::uint64_t hash_of(const kerf::Vec3f& p) {
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

VertexJoiner::VertexJoiner() : table_(min_slots, Slot{0, none}) {}

void VertexJoiner::add(std::span<const kerf::Vec3f> positions, std::uint32_t* numbers) {
  for (std::size_t begin = 0; begin < positions.size(); begin += positions_ahead) {
    const std::span some = positions.subspan(begin, std::min(positions_ahead, positions.size() - begin));
    std::uint64_t hashes[positions_ahead];
    for (std::size_t i = 0; i < some.size(); ++i) {
      hashes[i] = hash_of(some[i]);
      __builtin_prefetch(&table_[hashes[i] & (table_.size() - 1)]);
    }
    for (std::size_t i = 0; i < some.size(); ++i) *numbers++ = add(some[i], hashes[i]);
  }
}

std::uint32_t VertexJoiner::add(const kerf::Vec3f& position, std::uint64_t hash) {
  const auto tag = static_cast<std::uint32_t>(hash >> 32);
  const std::size_t mask = table_.size() - 1;
  std::size_t slot = hash & mask;
  for (; table_[slot].vertex != none; slot = (slot + 1) & mask) {
    if (table_[slot].tag == tag && same_bits(vertices_[table_[slot].vertex], position))
      return table_[slot].vertex;
  }
  const auto number = static_cast<std::uint32_t>(vertices_.size());
  table_[slot] = {tag, number};
  vertices_.push_back(position);
  if (2 * vertices_.size() > table_.size()) grow();
  return number;
}

void VertexJoiner::grow() {
  table_.assign(2 * table_.size(), Slot{0, none});
  const std::size_t mask = table_.size() - 1;
  for (std::uint32_t i = 0; i < vertices_.size(); ++i) {
    const std::uint64_t hash = hash_of(vertices_[i]);
    std::size_t slot = hash & mask;
    while (table_[slot].vertex != none) slot = (slot + 1) & mask;
    table_[slot] = {static_cast<std::uint32_t>(hash >> 32), i};
  }
}

std::vector<kerf::Vec3f> VertexJoiner::take_vertices() {
  table_.assign(min_slots, Slot{0, none});
  return std::exchange(vertices_, {});
}

void join_vertices(Scene& scene) {
  VertexJoiner joiner;
  std::vector<std::uint32_t> kept_as(scene.vertices.size(), none);
  for (auto& triangle : scene.triangles) {
    for (std::uint32_t& vertex : triangle) {
      if (kept_as[vertex] == none) joiner.add(std::span(&scene.vertices[vertex], 1), &kept_as[vertex]);
      vertex = kept_as[vertex];
    }
  }
  scene.vertices = joiner.take_vertices();
}

}  // namespace workbench
