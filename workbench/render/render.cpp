#include "workbench/render/render.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "workbench/base/parallel.hpp"
#include "workbench/base/vectors.hpp"
#include "workbench/rays/camera.hpp"
#include "workbench/rays/rays.hpp"
#include "workbench/sampling/random.hpp"

namespace workbench {
namespace {

using namespace kerf;

// In diagonals of the scene, as for the ambient-occlusion rays that are measured.
constexpr float ambient_reach = 0.25f;
// Shorter in shaded pictures, where rooms smaller than the reach would be dark.
constexpr float shading_reach = 0.06f;
// The distance of the start of a secondary ray from its surface, in diagonals of the scene: well above the
// rounding error of a hit point.
constexpr float lift = 1e-5f;

// Linear light: a warm sun, a blue sky, and a little light from the camera, so that closed rooms are not
// black.
constexpr Vec3f clay{0.64f, 0.61f, 0.57f};
constexpr Vec3f sun_light{1.55f, 1.28f, 0.95f};
constexpr Vec3f sky_light{0.40f, 0.47f, 0.58f};
constexpr Vec3f ground_light{0.22f, 0.18f, 0.14f};
constexpr Vec3f camera_light{0.13f, 0.12f, 0.11f};
constexpr Vec3f bounced_light{0.07f, 0.055f, 0.04f};  // what reaches corners from the surfaces around them
constexpr Vec3f zenith{0.14f, 0.27f, 0.52f};
constexpr Vec3f horizon{0.62f, 0.72f, 0.84f};

// Behind what is open on all sides, and therefore white, in pictures of ambient occlusion.
constexpr Vec3f behind{0.09f, 0.12f, 0.17f};

Vec3f mix(const Vec3f& a, const Vec3f& b, float t) {
  return (1.0f - t) * a + t * b;
}
Vec3f multiply(const Vec3f& a, const Vec3f& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

struct Frame {
  Vec3f x, y, z;
};

Frame frame_around(const Vec3f& z) {
  const Vec3f other = std::abs(z.x) > 0.7f ? Vec3f{0, 1, 0} : Vec3f{1, 0, 0};
  const Vec3f x = normalize(cross(other, z));
  return {x, cross(z, x), z};
}

struct Surface {
  Vec3f point;   // lifted off the surface towards the viewer
  Vec3f normal;  // faces the viewer
  float distance;
};

class Studio {
 public:
  Studio(const Traced& traced, const Viewpoint& viewpoint)
      : traced_(traced), up_(normalize(viewpoint.up)), diagonal_(length(extent(traced.bounds()))) {
    // The sun is behind the viewer's left shoulder, half way up.
    const Vec3f back = normalize(viewpoint.position - viewpoint.target);
    const Frame frame = frame_around(up_);
    const float along_x = dot(back, frame.x), along_y = dot(back, frame.y);
    const Vec3f level = along_x * frame.x + along_y * frame.y;
    const Vec3f toward = length(level) > 1e-3f ? normalize(level) : frame.x;
    sun_ = normalize(0.55f * toward + 0.65f * cross(toward, up_) + 1.15f * up_);
  }

  std::optional<Surface> hit(const Ray& ray) const {
    const auto hit = traced_.intersect(ray);
    if (!hit) return std::nullopt;
    const auto& [a, b, c] = hit->triangle;
    Vec3f normal = cross(b - a, c - a);
    const float size = length(normal);
    normal = size > 0.0f ? (1.0f / size) * normal : -1.0f * ray.direction;
    if (dot(normal, ray.direction) > 0.0f) normal = -1.0f * normal;
    return Surface{ray.origin + hit->t * ray.direction + lift * diagonal_ * normal, normal, hit->t};
  }

  // The fraction of the cosine-weighted hemisphere that is open within `reach` diagonals.
  float openness(const Surface& surface, float reach, unsigned samples, RandomNumbers& random) const {
    const Frame frame = frame_around(surface.normal);
    const float turn = random.uniform();
    unsigned open = 0;
    for (unsigned i = 0; i < samples; ++i) {  // stratified in radius, and in angle by the golden ratio
      const float r2 = (static_cast<float>(i) + random.uniform()) / static_cast<float>(samples);
      const float angle = 2.0f * std::numbers::pi_v<float> * (turn + 0.61803399f * static_cast<float>(i));
      const float r = std::sqrt(r2), z = std::sqrt(1.0f - r2);
      const Vec3f direction = r * std::cos(angle) * frame.x + r * std::sin(angle) * frame.y + z * frame.z;
      open += !traced_.occluded({surface.point, direction, 0.0f, reach * diagonal_});
    }
    return static_cast<float>(open) / static_cast<float>(samples);
  }

  Vec3f sky(const Vec3f& direction) const {
    const float height = std::max(0.0f, dot(direction, up_));
    const float glow = std::max(0.0f, dot(direction, sun_));
    return mix(horizon, zenith, std::sqrt(height)) + std::pow(glow, 64.0f) * Vec3f{0.35f, 0.28f, 0.16f};
  }

  Vec3f shade(const Surface& surface, const Vec3f& view, unsigned samples, RandomNumbers& random) const {
    const float open = openness(surface, shading_reach, samples, random);
    const float upward = 0.5f + 0.5f * dot(surface.normal, up_);
    const Vec3f dome =
        mix(ground_light, sky_light, upward) + std::abs(dot(surface.normal, view)) * camera_light;
    Vec3f light = mix(bounced_light, dome, open);
    const float facing = dot(surface.normal, sun_);
    if (facing > 0.0f && !traced_.occluded({surface.point, sun_})) light = light + facing * sun_light;
    const float haze = 1.0f - std::exp(-0.35f * surface.distance / diagonal_);
    return mix(multiply(clay, light), horizon, 0.15f * haze);
  }

 private:
  const Traced& traced_;
  Vec3f up_, sun_;
  float diagonal_;
};

// Compresses highlights instead of clipping them, then encodes with a power of 1 / 2.2, which is close to
// sRGB.
Pixel develop(const Vec3f& light) {
  Pixel pixel{};
  for (int c = 0; c < 3; ++c) {
    const float rolled = 1.0f - std::exp(-1.35f * light[c]);
    const float encoded = std::pow(rolled, 1.0f / 2.2f);
    pixel[static_cast<std::size_t>(c)] =
        static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(encoded, 0.0f, 1.0f)));
  }
  return pixel;
}

// Each pixel is the mean of `light_along(ray, random)` over a grid of camera rays.
template <class LightAlong>
Image render(const Viewpoint& viewpoint, const RenderOptions& options, const LightAlong& light_along) {
  Image image(options.width, options.height);
  const Camera camera(viewpoint, options.width, options.height);
  const float cell = 1.0f / static_cast<float>(options.samples);
  std::mutex progress_mutex;
  std::size_t rows_done = 0;
  const std::size_t block = options.block, rows = (options.height + block - 1) / block;
  const auto side = static_cast<float>(block);
  parallel_for(rows, [&](std::size_t row) {
    const std::size_t y = row * block;
    for (std::size_t x = 0; x < options.width; x += block) {
      RandomNumbers random(y * options.width + x);
      Vec3f sum;
      for (unsigned i = 0; i < options.samples * options.samples; ++i) {
        const float across = (static_cast<float>(i % options.samples) + random.uniform()) * cell;
        const float down = (static_cast<float>(i / options.samples) + random.uniform()) * cell;
        sum = sum + light_along(camera.ray_through(static_cast<float>(x) + side * across,
                                                   static_cast<float>(y) + side * down),
                                random);
      }
      fill(image, x, y, block, block, develop(cell * cell * sum));
    }
    const std::lock_guard lock(progress_mutex);
    ++rows_done;
    if (options.progress) options.progress(static_cast<double>(rows_done) / static_cast<double>(rows));
  });
  return image;
}

}  // namespace

RenderOptions affordable(const Bvh& bvh, const Viewpoint& viewpoint, const RenderOptions& options,
                         double max_visits) {
  constexpr std::size_t across = 37, down = 23;
  constexpr std::size_t stride =
      397;  // a prime that divides neither: any first rays are spread over the picture
  constexpr std::uint64_t max_visits_of_probe = std::uint64_t{1} << 28;
  const Camera camera(viewpoint, across, down);
  std::vector<Ray> probe;
  for (std::size_t i = 0; i < across * down; ++i) {
    const std::size_t place = i * stride % (across * down);
    probe.push_back(camera.ray_through(static_cast<float>(place % across) + 0.5f,
                                       static_cast<float>(place / across) + 0.5f));
  }
  const double of_a_ray = visits_per_ray(bvh, probe, max_visits_of_probe);
  RenderOptions result = options;
  while (result.samples > 1 && result.samples * result.samples * of_a_ray > max_visits) --result.samples;
  if (result.samples == 1) {
    const double side = std::ceil(std::sqrt(of_a_ray / max_visits));
    const double largest = static_cast<double>(std::max(options.width, options.height));
    result.block = static_cast<std::size_t>(std::clamp(side, 1.0, largest));
  }
  return result;
}

std::string remark_on(const RenderOptions& given, const RenderOptions& asked) {
  if (given.samples == asked.samples && given.block == asked.block) return "";
  return fmt::format(
      "the picture has {}: so much lies over one another that a ray visits thousands of nodes "
      "and triangles",
      given.block > asked.block ? fmt::format("blocks of {0}x{0} pixels", given.block)
                                : fmt::format("{} camera rays a pixel, not {}", given.samples * given.samples,
                                              asked.samples * asked.samples));
}

Image render_shaded(const Traced& traced, const Viewpoint& viewpoint, const RenderOptions& options) {
  const Studio studio(traced, viewpoint);
  return render(viewpoint, options, [&](const Ray& ray, RandomNumbers& random) {
    const auto surface = studio.hit(ray);
    return surface ? studio.shade(*surface, ray.direction, options.ambient_samples, random)
                   : studio.sky(ray.direction);
  });
}

Image render_ambient_occlusion(const Traced& traced, const Viewpoint& viewpoint,
                               const RenderOptions& options) {
  const Studio studio(traced, viewpoint);
  return render(viewpoint, options, [&](const Ray& ray, RandomNumbers& random) {
    const auto surface = studio.hit(ray);
    if (!surface) return behind;
    // `develop` makes almost white of 2.
    const float light = 2.0f * studio.openness(*surface, ambient_reach, options.ambient_samples, random);
    return Vec3f{light, light, light};
  });
}

}  // namespace workbench
