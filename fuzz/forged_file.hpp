// Damaged .kerf files with correct checksums, and the queries that a file must survive if it loads.
#pragma once

#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <kerf/kerf.hpp>
#include <kerf/scene.hpp>

#include "base/aligned_array.hpp"
#include "files/checksum.hpp"
#include "files/file_header.hpp"
#include "files/read_image.hpp"
#include "files/scene_header.hpp"
#include "structure.hpp"

namespace forged {

/// Corrects all checksums of `image`, as far as its sizes allow.
inline void sign(std::span<std::byte> image) {
  using namespace kerf;
  FileHeader header;
  if (image.size() < sizeof header) return;
  std::memcpy(&header, image.data(), sizeof header);
  const std::uint64_t max = image.size() / sizeof(std::uint32_t);
  if (header.leaf_words <= max && header.nodes <= max && header.meshes <= max) {
    FileHeader sizes = header;
    if (header.version == FileHeader::oldest_version) sizes.node_width = 16;
    const FileLayout layout(sizes);
    const auto section = [&](std::uint64_t at, std::uint64_t bytes) {
      return at + bytes <= image.size() ? checksum(image.subspan(at, bytes)) : 0;
    };
    header.meshes_checksum = section(layout.meshes_at, layout.meshes_bytes);
    header.nodes_checksum = section(layout.nodes_at, layout.nodes_bytes);
    header.leaves_checksum = section(layout.leaves_at, layout.leaves_bytes);
    if (layout.annex_bytes != 0 && layout.annex_at + layout.annex_bytes <= image.size()) {
      constexpr std::size_t at = offsetof(FileAnnex, checksum),
                            masks_at = offsetof(FileAnnex, masks_checksum);
      const std::uint64_t masks_sum =
          layout.masks_bytes == 0 ? 0 : section(layout.masks_at, layout.masks_bytes);
      std::memcpy(image.data() + layout.annex_at + masks_at, &masks_sum, sizeof masks_sum);
      const std::uint64_t sum = section(layout.annex_at, at);
      std::memcpy(image.data() + layout.annex_at + at, &sum, sizeof sum);
    }
  }
  header.header_checksum =
      checksum(std::as_bytes(std::span(&header, 1)).first(offsetof(FileHeader, header_checksum)));
  std::memcpy(image.data(), &header, sizeof header);
}

/// The same for the file of a scene, and for the files of its hierarchies.
inline void sign_scene(std::span<std::byte> image) {
  using namespace kerf;
  SceneFileHeader header;
  if (image.size() < sizeof header) return;
  std::memcpy(&header, image.data(), sizeof header);
  const std::uint64_t max = image.size() / sizeof(std::uint64_t);
  const SceneLayout layout(header);
  if (header.instances <= max && layout.tables_at + layout.tables_bytes <= image.size()) {
    std::uint64_t at = layout.objects_at;
    for (std::uint32_t i = 0; i < header.objects && at <= image.size(); ++i) {
      std::uint64_t bytes;
      std::memcpy(&bytes, image.data() + layout.tables_at + i * sizeof bytes, sizeof bytes);
      if (bytes > image.size() - at) break;
      sign(image.subspan(at, bytes));
      at += bytes;
    }
    header.tables_checksum = checksum(image.subspan(layout.tables_at, layout.tables_bytes));
  }
  header.header_checksum =
      checksum(std::as_bytes(std::span(&header, 1)).first(offsetof(SceneFileHeader, header_checksum)));
  std::memcpy(image.data(), &header, sizeof header);
}

/// Loads `bytes`, the contents of a file, from memory that ends where they end, so that a sanitizer notices
/// every access beyond them.
inline kerf::Bvh load(std::span<const std::byte> bytes) {
  const kerf::AlignedArray<std::byte> image(bytes.size());
  if (!bytes.empty()) std::memcpy(image.data(), bytes.data(), bytes.size());
  return kerf::Structure::share(kerf::read_image({image.data(), image.size()}, image.owner()));
}

/// Aborts unless `answer` names a triangle that exists.
template <class Answer>
void check_name(const kerf::Bvh& bvh, const Answer& answer) {
  const auto& first = kerf::Structure::of(bvh).first_triangles;
  if (answer.mesh + 1 >= first.size() || answer.primitive >= first[answer.mesh + 1] - first[answer.mesh])
    std::abort();
}

/// Makes every kind of query. Each must return, and name triangles that exist.
inline void query(const kerf::Bvh& bvh) {
  const kerf::Box3f bounds = bvh.bounds();
  std::vector<kerf::Ray> rays;
  const kerf::Vec3f points[] = {{0.1f, 0.2f, 0.3f}, bounds.lower, {0, 0, 0}, {5, -7, 3}};
  for (const kerf::Vec3f& origin : points) {
    for (const kerf::Vec3f& direction :
         {kerf::Vec3f{1, 0, 0}, {-1, -1, -1}, {0.3f, -0.5f, 0.7f}, {0, 1e-30f, -1}}) {
      const kerf::Ray ray{.origin = origin, .direction = direction};
      if (const auto hit = bvh.intersect(ray)) check_name(bvh, *hit);
      (void)bvh.occluded(ray);
      rays.push_back(ray);
      bvh.all_hits(ray, [&](const kerf::Hit& hit) { check_name(bvh, hit); });
    }
    (void)bvh.contains(origin);
    (void)bvh.signed_distance(origin);
    if (const auto closest = bvh.closest_point(origin)) check_name(bvh, *closest);
    for (const auto& near : bvh.within(origin, 0.5f)) check_name(bvh, near);
  }
  std::vector<kerf::Hit> hits(rays.size());
  bvh.intersect(rays, hits);
  for (const kerf::Hit& hit : hits) {
    if (hit) check_name(bvh, hit);
  }
  std::vector<std::uint8_t> occluded(rays.size());
  bvh.occluded(rays, occluded);
  for (const auto& place : bvh.triangles_in({{-1, -1, -1}, {0.5f, 0.5f, 0.5f}})) check_name(bvh, place);
}

/// The same of a scene. Answers must name instances and their triangles.
inline void query(const kerf::Scene& scene) {
  const auto check_name = [&](const auto& answer) {
    if (answer.instance >= scene.instance_count()) std::abort();
    kerf::Scene at = scene;
    const std::vector<std::uint32_t> path = scene.path(answer.instance);
    for (std::size_t level = 0; level + 1 < path.size(); ++level) at = at.instances()[path[level]].scene;
    forged::check_name(at.instances()[path.back()].object, answer);
  };
  const kerf::Box3f bounds = scene.bounds();
  for (const kerf::Vec3f& origin : {kerf::Vec3f{0.1f, 0.2f, 0.3f}, bounds.lower, kerf::Vec3f{0, 0, 0}}) {
    for (const kerf::Vec3f& direction : {kerf::Vec3f{1, 0, 0}, {-1, -1, -1}, {0.3f, -0.5f, 0.7f}}) {
      const kerf::Ray ray{.origin = origin, .direction = direction};
      if (const auto hit = scene.intersect(ray)) check_name(*hit);
      (void)scene.occluded(ray);
      (void)scene.intersect(ray, [&](const kerf::SceneHit& hit) {
        check_name(hit);
        return false;
      });
      scene.all_hits(ray, check_name);
    }
    (void)scene.contains(origin);
    if (const auto closest = scene.closest_point(origin)) check_name(*closest);
    for (const auto& near : scene.within(origin, 0.5f)) check_name(near);
  }
  for (const auto& place : scene.triangles_in({{-1, -1, -1}, {0.5f, 0.5f, 0.5f}})) check_name(place);
  for (const auto& place : scene.triangles_in(bounds)) check_name(place);
}

}  // namespace forged
