#include "base/raise.hpp"

#include <string>

#include <gtest/gtest.h>

namespace kerf {
namespace {

Error error_of(const char* text) {
  try {
    raise(Error::io, "%s (%zu, %g)", text, std::size_t{7}, 0.5);
  } catch (const Error& error) {
    return error;
  }
}

TEST(Raise, MakesTheSentenceFromItsValues) {
  const Error error = error_of("100 % wrong");
  EXPECT_EQ(error.code(), Error::io);
  EXPECT_STREQ(error.what(), "100 % wrong (7, 0.5)");
}

TEST(Raise, CutsOffWhatAnErrorCannotHold) {
  const std::string text(2000, 'x');
  EXPECT_EQ(error_of(text.c_str()).what(), text.substr(0, 511));
}

}  // namespace
}  // namespace kerf
