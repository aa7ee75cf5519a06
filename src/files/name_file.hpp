// Errors name the file that they are about.
#pragma once

#include <filesystem>

#include "base/out_of_memory.hpp"
#include "base/parallel.hpp"
#include "base/raise.hpp"
#include "files/paths.hpp"

namespace kerf {

/// Calls `work(path)` and returns what it returns. The sentence of an `Error` that it throws gets the name of
/// the file in front.
template <class Work>
decltype(auto) naming_file(const FileName& name, const Work& work) {
  const std::filesystem::path path = report_out_of_memory([&] { return path_of(name); });
  try {
    return report_out_of_memory([&] { return isolated([&] { return work(path); }); });
  } catch (const Error& error) {
    if (error.code() == Error::io) throw;  // these have the name already
    raise(error.code(), "%s: %s", text_of(path).c_str(), error.what());
  }
}

}  // namespace kerf
