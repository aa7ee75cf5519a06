// What every JSON says of the run that it came from.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "workbench/report/machine.hpp"

namespace kerf_tool {

/// The date and the time, in UTC.
std::string now();

/// `date`, `threads`, `target` (the instruction set) and `machine` with `processor`, `threads`, `system` and
/// `compiler`.
nlohmann::ordered_json run_json(const workbench::Machine& machine, unsigned threads);

/// The text of `json`. What is not UTF-8, as names of files may be, has the replacement character in its
/// place.
std::string dump_json(const nlohmann::ordered_json& json);

}  // namespace kerf_tool
