#include "base/raise.hpp"

#include <cstdarg>
#include <cstdio>

namespace kerf {

void raise(Error::Code code, const char* format, ...) {
  char sentence[512];
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(sentence, sizeof sentence, format, values);
  va_end(values);
  throw Error(code, sentence);
}

}  // namespace kerf
