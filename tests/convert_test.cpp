// Which types become points and rays.
#include <array>
#include <span>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/convert.hpp>
#include <kerf/kerf.hpp>

#include "support/vector_libraries.hpp"

namespace kerf {
namespace {

template <class V>
constexpr bool is_vec3f = requires(const V& v) {
  to_vec3f(v);
};
template <class V>
constexpr bool is_vec3d = requires(const V& v) {
  to_vec3d(v);
};

struct Named {
  float x, y, z;
};
struct Homogeneous {
  float x, y, z, w;
};
struct NamedDoubles {
  double x, y, z;
};

// As Qt has it.
class Functions {
 public:
  Functions(float x, float y, float z) : x_(x), y_(y), z_(z) {}
  float x() const { return x_; }
  float y() const { return y_; }
  float z() const { return z_; }

 private:
  float x_, y_, z_;
};

static_assert(is_vec3f<Vec3f> && is_vec3f<Named> && is_vec3f<Functions> && is_vec3f<std::array<float, 3>> &&
              is_vec3f<float[3]> && is_vec3f<std::span<const float, 3>>);
static_assert(!is_vec3f<Vec3d> && !is_vec3f<NamedDoubles> && !is_vec3f<std::array<double, 3>> &&
              !is_vec3f<double[3]> && !is_vec3f<std::array<int, 3>>);
static_assert(!is_vec3f<std::array<float, 2>> && !is_vec3f<std::array<float, 4>> && !is_vec3f<Homogeneous> &&
              !is_vec3f<std::vector<float>> && !is_vec3f<std::span<const float>> && !is_vec3f<float> &&
              !is_vec3f<float*>);
static_assert(is_vec3d<Vec3d> && is_vec3d<Vec3f> && is_vec3d<NamedDoubles> &&
              is_vec3d<std::array<double, 3>> && !is_vec3d<std::array<int, 3>>);
static_assert(std::is_aggregate_v<Vec3f> && std::is_aggregate_v<Ray>);
#ifdef KERF_WITH_EIGEN
static_assert(is_vec3f<Eigen::Vector3f> && is_vec3f<Eigen::RowVector3f> && !is_vec3f<Eigen::Vector4f> &&
              !is_vec3f<Eigen::Vector3d> && !is_vec3f<Eigen::VectorXf> && !is_vec3f<Eigen::Matrix3f>);
static_assert(is_vec3d<Eigen::Vector3d>);
#endif
#ifdef KERF_WITH_GLM
static_assert(is_vec3f<glm::vec3> && !is_vec3f<glm::dvec3> && !is_vec3f<glm::vec4> && !is_vec3f<glm::ivec3> &&
              is_vec3d<glm::dvec3>);
#endif

TEST(Convert, AnyThreeFloatsAreAPoint) {
  const Vec3f expected{1, 2, 3};
  const float scalars[3] = {1, 2, 3};
  EXPECT_EQ(to_vec3f(scalars), expected);
  EXPECT_EQ(to_vec3f(std::array<float, 3>{1, 2, 3}), expected);
  EXPECT_EQ(to_vec3f(std::span<const float, 3>(scalars)), expected);
  EXPECT_EQ(to_vec3f(Named{1, 2, 3}), expected);
  EXPECT_EQ(to_vec3f(Functions{1, 2, 3}), expected);
#ifdef KERF_WITH_EIGEN
  const Eigen::Vector3f eigen(1, 2, 3);
  EXPECT_EQ(to_vec3f(eigen), expected);
  EXPECT_EQ(to_vec3f(2.0f * eigen - eigen), expected);
  EXPECT_EQ(to_vec3f(Eigen::Map<const Eigen::Vector3f>(scalars)), expected);
#endif
#ifdef KERF_WITH_GLM
  EXPECT_EQ(to_vec3f(glm::vec3(1, 2, 3)), expected);
#endif
}

TEST(Convert, RaysComeFromAnyTwoVectors) {
  const Ray ray = to_ray(std::array<float, 3>{1, 2, 3}, Named{4, 5, 6}, 0.5f, 9.0f);
  EXPECT_EQ(ray.origin, (Vec3f{1, 2, 3}));
  EXPECT_EQ(ray.direction, (Vec3f{4, 5, 6}));
  EXPECT_EQ(ray.t_min, 0.5f);
  EXPECT_EQ(ray.t_max, 9.0f);
  const DoubleRay far = to_double_ray(std::array<double, 3>{5e5, 4.6e6, 0}, Named{0, 0, 1});
  EXPECT_EQ(far.origin, (Vec3d{5e5, 4.6e6, 0}));
  EXPECT_EQ(far.direction, (Vec3d{0, 0, 1}));
}

}  // namespace
}  // namespace kerf
