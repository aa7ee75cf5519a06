#include "workbench/report/html.hpp"

#include <string_view>
#include <vector>

#include <gtest/gtest.h>

using namespace workbench;

TEST(Html, Base64IsThatOfTheRfc) {
  const auto encode = [](std::string_view text) {
    return base64(std::vector<std::uint8_t>(text.begin(), text.end()));
  };
  // RFC 4648, section 10.
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foob"), "Zm9vYg==");
  EXPECT_EQ(encode("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encode("\xff\xfe\xfd"), "//79");
}

TEST(Html, NothingGetsOutOfItsPlace) {
  EXPECT_EQ(escape_html("<a title=\"x\">&"), "&lt;a title=&quot;x&quot;&gt;&amp;");
  EXPECT_EQ(escape_script("{\"name\":\"</script>\"}"), "{\"name\":\"\\u003c/script>\"}");
}
