// Which ranges, matrices and addresses become views, and what the views then show.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>
#include <kerf/kerf.hpp>
#include <kerf/mesh.hpp>
#include <kerf/triangle.hpp>

#include "support/vector_libraries.hpp"

namespace kerf {
namespace {

template <class Scalar, class... From>
constexpr bool views = std::is_constructible_v<TripleView<Scalar>, From...>;
template <class Element>
constexpr bool are_points = views<float, std::vector<Element>&>;
template <class Element>
constexpr bool are_triangles = views<std::uint32_t, std::vector<Element>&>;

struct WithNormal {
  float position[3], normal[3];
};
struct Nested {
  WithNormal vertex;
  int id;
};
struct NormalFirst {
  float nx, ny, nz, x, y, z;
};
struct Doubles {
  double x, y, z;
};
struct Apart {
  float x, u, y, v, z;
};
struct Face {
  std::uint32_t a, b, c;
};
struct Quadrilateral {
  std::uint32_t a, b, c, d;
};

// As a vector of Eigen, without Eigen.
class Opaque {
 public:
  Opaque() = default;
  Opaque(const Opaque& other) : values_{other[0], other[1], other[2]} {}
  Opaque& operator=(const Opaque&) = default;
  float& operator[](int i) { return values_[i]; }
  const float& operator[](int i) const { return values_[i]; }

 private:
  float values_[3]{};
};

// Three floats or three 32-bit indices, by whatever name.
static_assert(are_points<float> && are_points<float[3]> && are_points<std::array<float, 3>>);
static_assert(are_points<Vec3f> && are_points<Triangle> && are_points<WithNormal> && are_points<Nested>);
static_assert(are_points<NormalFirst> && are_points<Opaque> && are_points<std::array<float, 4>>);
static_assert(are_triangles<unsigned> && are_triangles<int> && are_triangles<std::array<int, 3>>);
static_assert(are_triangles<std::array<std::uint32_t, 3>> && are_triangles<Face>);
static_assert(views<float, const std::vector<Vec3f>&> && views<float, float (&)[9]> &&
              views<float, float (&)[3][3]> && views<float, std::span<const Vec3f>>);
static_assert(views<float, float*, std::size_t> && views<float, const float*, std::size_t, std::size_t> &&
              views<float, const WithNormal*, std::size_t> && views<std::uint32_t, int*, std::size_t>);

// Other scalars.
static_assert(!are_points<double> && !are_points<std::array<double, 3>> && !are_points<Doubles>);
static_assert(!are_points<int> && !are_points<std::array<int, 3>> && !are_points<Face>);
static_assert(!are_triangles<std::size_t> && !are_triangles<std::array<std::size_t, 3>>);
static_assert(!are_triangles<std::uint16_t> && !are_triangles<std::array<std::uint16_t, 6>>);
static_assert(!are_triangles<float> && !are_triangles<Vec3f> && !are_triangles<bool> &&
              !are_triangles<char32_t>);

// Another number of them, or not in the element itself.
static_assert(!are_points<std::array<float, 2>> && !are_points<std::array<float, 9>> && !are_points<Apart>);
static_assert(!are_points<std::tuple<float, float, float>> && !are_points<std::array<Vec3f, 3>>);
static_assert(!are_points<std::vector<float>> && !are_points<std::span<float>> && !are_points<float*>);
static_assert(!are_triangles<std::array<unsigned, 4>> && !are_triangles<Quadrilateral>);

// Temporaries.
static_assert(!views<float, std::vector<Vec3f>> && !views<float, const std::vector<float>> &&
              !views<float, std::array<float, 9>>);

// Addresses.
static_assert(!views<float, double*, std::size_t> && !views<float, double*, std::size_t, std::size_t> &&
              !views<float, Doubles*, std::size_t, std::size_t> &&
              !views<float, int*, std::size_t, std::size_t> &&
              !views<std::uint32_t, std::size_t*, std::size_t>);
static_assert(views<float, const void*, std::size_t, std::size_t> &&
              !views<float, const void*, std::size_t> && views<float, std::byte*, std::size_t, std::size_t>);

#ifdef KERF_WITH_EIGEN
using Rows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
static_assert(are_points<Eigen::Vector3f> && are_points<Eigen::RowVector3f> && are_points<Eigen::Vector4f>);
static_assert(!are_points<Eigen::Vector3d> && !are_points<Eigen::Matrix3f> && !are_points<Eigen::VectorXf> &&
              !are_points<Eigen::Map<Eigen::Vector3f>>);
static_assert(are_triangles<Eigen::Vector3i> && !are_triangles<Eigen::Vector4i>);
static_assert(views<float, Rows&> && views<float, const Rows&> && views<float, Eigen::Map<Rows>&> &&
              views<float, Eigen::Matrix3Xf&> && views<std::uint32_t, Eigen::Matrix3Xi&>);
static_assert(!views<float, Eigen::MatrixXf&> && !views<float, Eigen::Matrix<float, Eigen::Dynamic, 3>&> &&
              !views<float, Eigen::MatrixX3d&> && !views<float, Rows>);

TEST(Mesh, AMatrixWithATripleInEachRowOrColumnIsAView) {
  Rows rows = Rows::Random(5, 3);
  Eigen::Matrix3Xf columns = rows.transpose();
  const TripleView<float> of_rows(rows), of_columns(columns);
  ASSERT_EQ(of_rows.size(), 5u);
  ASSERT_EQ(of_columns.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(of_rows[static_cast<std::size_t>(i)].values[axis], rows(i, axis));
      EXPECT_EQ(of_columns[static_cast<std::size_t>(i)].values[axis], rows(i, axis));
    }
  }
}

TEST(Mesh, AMapThatStepsOverScalarsIsRefused) {
  float scalars[18]{};
  Eigen::Map<Rows, 0, Eigen::Stride<6, 2>> stepping(scalars, 3, 3);
  EXPECT_THROW(TripleView<float>{stepping}, Error);
}
#endif

#ifdef KERF_WITH_GLM
static_assert(are_points<glm::vec3> && are_points<glm::vec4> && !are_points<glm::dvec3> &&
              !are_points<glm::vec2> && !are_points<glm::mat3> && !are_points<glm::ivec3>);
static_assert(are_triangles<glm::uvec3> && are_triangles<glm::ivec3> && !are_triangles<glm::uvec4>);

struct GlmVertex {
  glm::vec3 position, normal;
};
static_assert(are_points<GlmVertex>);
#endif

TEST(Mesh, AFlatRangeOfNoWholeNumberOfTriplesIsRefused) {
  const std::vector<float> eight(8);
  const std::vector<unsigned> four(4);
  for (const auto& make :
       {+[](const std::vector<float>&f, const std::vector<unsigned>&) { (void)TripleView<float>(f); },
        +[](const std::vector<float>&, const std::vector<unsigned>&u) {
          (void)TripleView<std::uint32_t>(u);
        }}) {
    try {
      make(eight, four);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::invalid_argument);
      EXPECT_NE(std::string(error.what()).find("multiple of three"), std::string::npos) << error.what();
    }
  }
}

TEST(Mesh, MembersNamedXYZAreFoundBehindOthers) {
  const std::vector<NormalFirst> vertices{{9, 9, 9, 1, 2, 3}, {9, 9, 9, 4, 5, 6}};
  for (const TripleView<float>& view : {TripleView<float>(vertices), {vertices.data(), vertices.size()}}) {
    ASSERT_EQ(view.size(), 2u);
    EXPECT_EQ(view[0].values[0], 1.0f);
    EXPECT_EQ(view[1].values[2], 6.0f);
  }
}

TEST(Mesh, ElementsThatCopyThemselvesAreReadAsTheyLie) {
  std::vector<Opaque> vertices(3);
  vertices[1][0] = vertices[2][1] = 1.0f;
  const std::vector<Face> faces{{0, 1, 2}};
  const Bvh bvh = build({.vertices = vertices, .triangles = faces});
  EXPECT_TRUE(bvh.occluded({.origin = {0.25f, 0.25f, 1}, .direction = {0, 0, -1}}));
}

TEST(Mesh, AnEmptyRangeIsAViewOfNothing) {
  EXPECT_EQ(TripleView<float>(std::span<const NormalFirst>()).size(), 0u);
  EXPECT_EQ(TripleView<float>(std::span<const float>()).size(), 0u);
}

}  // namespace
}  // namespace kerf
