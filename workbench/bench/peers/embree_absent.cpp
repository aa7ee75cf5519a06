#include "workbench/bench/peers/embree.hpp"

namespace workbench {

std::vector<std::string> embree_isas() {
  return {};
}

std::vector<Engine> embree_engines(unsigned, const std::string&) {
  return {};
}

}  // namespace workbench
