#include "run_json.hpp"

#include <chrono>

#include <fmt/chrono.h>
#include <kerf/inspect.hpp>

namespace kerf_tool {

using Json = nlohmann::ordered_json;

std::string now() {
  return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::chrono::system_clock::now()));
}

Json run_json(const workbench::Machine& machine, unsigned threads) {
  return {{"date", now()},
          {"threads", threads},
          {"target", kerf::instruction_set()},
          {"machine",
           {{"processor", machine.processor},
            {"threads", machine.threads},
            {"system", machine.system},
            {"compiler", machine.compiler}}}};
}

std::string dump_json(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace kerf_tool
