// What the library answers on this machine, for the tests to compare with what it answers in WebAssembly.
//
// usage: kerf_web_answers IN OUT
//
// IN: the numbers of vertices, triangles, rays and points (32 bits each); three floats a vertex, three
// numbers a triangle, six floats a ray, three a point. OUT: for each ray t, u, v, the triangle and how many
// hits there are; for each point the closest point of the surface with its distance, u, v and triangle, and
// the signed distance; then the number of references.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <vector>

#include <kerf/kerf.hpp>

namespace {

template <class T>
std::vector<T> read(std::istream& in, std::size_t count) {
  std::vector<T> values(count);
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
  return values;
}
template <class T>
void write(std::ostream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  std::ifstream in(argv[1], std::ios::binary);
  const auto counts = read<std::uint32_t>(in, 4);
  const auto vertices = read<float>(in, std::size_t{3} * counts[0]);
  const auto triangles = read<std::uint32_t>(in, std::size_t{3} * counts[1]);
  const auto rays = read<float>(in, std::size_t{6} * counts[2]);
  const auto points = read<float>(in, std::size_t{3} * counts[3]);
  if (!in) {
    std::fprintf(stderr, "%s: is too short\n", argv[1]);
    return 1;
  }
  const kerf::Bvh bvh = kerf::build({.vertices = vertices, .triangles = triangles});
  const kerf::RayView view = kerf::RayView::six_floats(rays.data(), counts[2]);
  std::vector<kerf::Hit> hits(counts[2]);
  std::vector<std::uint32_t> hit_counts(counts[2]);
  std::vector<kerf::SurfacePoint> closest(counts[3]);
  std::vector<float> distances(counts[3]);
  bvh.intersect(view, hits);
  bvh.count_hits(view, hit_counts);
  bvh.closest_point(points, closest);
  bvh.signed_distance(points, distances);

  std::ofstream out(argv[2], std::ios::binary);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    write(out, hits[i].t);
    write(out, hits[i].u);
    write(out, hits[i].v);
    write(out, hits[i].primitive);
    write(out, hit_counts[i]);
  }
  for (std::size_t i = 0; i < closest.size(); ++i) {
    write(out, closest[i].position);
    write(out, closest[i].distance);
    write(out, closest[i].u);
    write(out, closest[i].v);
    write(out, closest[i].primitive);
    write(out, distances[i]);
  }
  write(out, static_cast<std::uint32_t>(bvh.statistics().references));
  return out ? 0 : 1;
}
