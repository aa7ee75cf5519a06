#include "workbench/bench/peers/embree.hpp"

namespace workbench {

std::vector<Engine> embree_engines(unsigned) {
  return {};
}

}  // namespace workbench
