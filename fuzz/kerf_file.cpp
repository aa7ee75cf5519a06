// The loader of .kerf files. Checksums are corrected first, as a forger would do, so that the fuzzer reaches
// the code behind them. A file that loads must answer every kind of query.
#include <cstring>

#include "fuzz/forged_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string file(reinterpret_cast<const char*>(data), size);
  try {
    (void)forged::load(std::as_bytes(std::span(file)));
  } catch (const kerf::Error&) {  // of almost every file that is not signed
  }
  forged::sign(std::as_writable_bytes(std::span(file)));
  try {
    forged::query(forged::load(std::as_bytes(std::span(file))));
  } catch (const kerf::Error&) {
  }
  return 0;
}
