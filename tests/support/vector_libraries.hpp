// Libraries whose vectors and matrices callers have, where they are installed.
#pragma once

#if __has_include(<eigen3/Eigen/Core>)
#include <eigen3/Eigen/Core>
#define KERF_WITH_EIGEN
#endif
#if __has_include(<glm/glm.hpp>)
#include <glm/glm.hpp>
#define KERF_WITH_GLM
#endif
