// The loader of .kerf files. Checksums are set right first, as a forger would: the bytes behind them are what
// a fuzzer has to reach. What loads must answer every kind of question.
#include <cstring>

#include "fuzz/forged_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string file(reinterpret_cast<const char*>(data), size);
  try {
    (void)forged::load(std::as_bytes(std::span(file)));
  } catch (const kerf::Error&) {  // as almost every file that is not signed
  }
  forged::sign(std::as_writable_bytes(std::span(file)));
  try {
    forged::question(forged::load(std::as_bytes(std::span(file))));
  } catch (const kerf::Error&) {
  }
  return 0;
}
