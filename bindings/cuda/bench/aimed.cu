#include "../src/device_array.hpp"
#include "aimed.hpp"

namespace kerf::cuda {
namespace {

// SplitMix64 (Steele, Lea & Flood 2014).
struct RandomNumbers {
  std::uint64_t state;
  __device__ static std::uint64_t scramble(std::uint64_t x) {
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
  }
  __device__ explicit RandomNumbers(std::uint64_t seed) : state(scramble(seed + 0x9e3779b97f4a7c15u)) {}
  __device__ std::uint64_t bits() { return scramble(state += 0x9e3779b97f4a7c15u); }
  __device__ std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>((bits() >> 32) * count >> 32);
  }
  __device__ float uniform() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
};

__global__ void make(AimedSource source, std::uint64_t first, std::uint32_t count, Ray* rays) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  RandomNumbers random(first + i);
  const Vec3f inside = source.inside[random.below(source.inside_count)];
  const auto& triangle = source.triangles[random.below(source.triangle_count)];
  const std::uint32_t corner = random.below(3);
  const Vec3f a = source.vertices[triangle[corner]], b = source.vertices[triangle[(corner + 1) % 3]];
  const std::uint32_t kind = random.below(3);
  const float s = kind == 0 ? 0.0f : kind == 1 ? 0.5f : random.uniform();
  Vec3f at;
  at.x = (1.0f - s) * a.x + s * b.x;
  at.y = (1.0f - s) * a.y + s * b.y;
  at.z = (1.0f - s) * a.z + s * b.z;
  Ray ray;
  ray.t_min = 0.0f;
  ray.origin = inside;
  ray.direction.x = at.x - inside.x;
  ray.direction.y = at.y - inside.y;
  ray.direction.z = at.z - inside.z;
  ray.t_max = __int_as_float(0x7f800000);
  if ((first + i) % 2 == 1) {
    // Far enough along the ray to lie outside.
    const double x = ray.direction.x, y = ray.direction.y, z = ray.direction.z;
    const double ox = double{inside.x} - source.center.x, oy = double{inside.y} - source.center.y,
                 oz = double{inside.z} - source.center.z;
    const double reach = (1.0 + random.uniform()) * (source.radius + sqrt(ox * ox + oy * oy + oz * oz));
    const double scale = reach / sqrt(x * x + y * y + z * z);
    ray.origin.x = static_cast<float>(inside.x + scale * x);
    ray.origin.y = static_cast<float>(inside.y + scale * y);
    ray.origin.z = static_cast<float>(inside.z + scale * z);
    ray.direction.x = inside.x - ray.origin.x;
    ray.direction.y = inside.y - ray.origin.y;
    ray.direction.z = inside.z - ray.origin.z;
    ray.t_max = 1.0f;
  }
  rays[i] = ray;
}

template <class Missed>
__device__ void add_misses(std::uint32_t count, unsigned long long* misses, Missed&& missed) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  const std::uint32_t lanes = __ballot_sync(0xffffffffu, i < count && missed(i));
  if (lanes != 0 && (threadIdx.x & 31) == 0)
    atomicAdd(misses, static_cast<unsigned long long>(__popc(lanes)));
}
__global__ void count_hits(const Hit* hits, std::uint32_t count, unsigned long long* misses) {
  add_misses(count, misses, [&](std::uint32_t i) { return hits[i].primitive == invalid_id; });
}
__global__ void count_results(const std::uint8_t* results, std::uint32_t count, unsigned long long* misses) {
  add_misses(count, misses, [&](std::uint32_t i) { return results[i] == 0; });
}

}  // namespace

void make_aimed_rays(const AimedSource& source, std::uint64_t first, std::uint32_t count, Ray* rays) {
  make<<<(count + 127) / 128, 128>>>(source, first, count, rays);
  check(cudaGetLastError(), "making aimed rays");
}
void count_misses(const Hit* hits, std::uint32_t count, unsigned long long* misses) {
  count_hits<<<(count + 127) / 128, 128>>>(hits, count, misses);
  check(cudaGetLastError(), "counting misses");
}
void count_misses(const std::uint8_t* results, std::uint32_t count, unsigned long long* misses) {
  count_results<<<(count + 127) / 128, 128>>>(results, count, misses);
  check(cudaGetLastError(), "counting misses");
}

}  // namespace kerf::cuda
