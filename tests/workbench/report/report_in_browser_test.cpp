// The report as a reader sees it: opened in a real browser, its scripts run, its pictures decoded.
#include <cstdlib>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "support/run_tool.hpp"
#include "support/temporary_directory.hpp"

namespace {

using namespace kerf_tests;

constexpr std::string_view browser = KERF_BROWSER;

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// The document after its scripts have run.
std::string open_in_browser(const std::string& page, const std::string& profile) {
  const Outcome outcome = run_command(
      std::string(browser) +
      " --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking"
      " --disable-component-update --disable-sync --disable-dev-shm-usage --virtual-time-budget=10000"
      " --user-data-dir=" +
      profile + " --dump-dom file://" + page);
  EXPECT_EQ(outcome.status, 0) << outcome.errors;
  return outcome.output;
}

class ReportInBrowser : public testing::Test {
 protected:
  void SetUp() override {
    if (browser.ends_with("NOTFOUND")) {
      ASSERT_EQ(std::getenv("KERF_REQUIRE_BROWSER"), nullptr)
          << "no Chromium was found when this was configured";
      GTEST_SKIP() << "no Chromium was found when this was configured";
    }
  }

  // Makes a report, opens it, and checks what must hold for any.
  std::string make_and_open(const std::string& arguments) {
    const Outcome made = run_tool(arguments + " --pixels 24x16 --rounds 3 --pictures 48x32 --report " +
                                  directory_.file("report"));
    EXPECT_EQ(made.status, 0) << made.errors;
    const std::string page = directory_.file("report/index.html");
    EXPECT_NE(made.output.find(page), std::string::npos) << "the tool says where the report is";

    // All that the page could load is in the page.
    const std::string source = read_bytes(page);
    const std::regex reference("<[a-z][^>]* (src|href)=\"([^\"]{0,5})");
    for (std::sregex_iterator match(source.begin(), source.end(), reference), end; match != end; ++match) {
      EXPECT_TRUE((*match)[2].str() == "data:" || (*match)[2].str()[0] == '#') << match->str();
    }
    EXPECT_EQ(source.find("url("), std::string::npos);
    EXPECT_EQ(source.find("@import"), std::string::npos);

    const std::string document = open_in_browser(page, directory_.file("profile"));
    EXPECT_NE(document.find("data-errors=\"0\""), std::string::npos) << "script errors or refused loads";
    return document;
  }

  TemporaryDirectory directory_;
};

TEST_F(ReportInBrowser, ComparisonShowsTablesChartsAndPictures) {
  const std::string document = make_and_open("compare sticks:detail=0.02 terrain:detail=0.01,rotate=30");
  EXPECT_EQ(count(document, "<section id=\"scene-"), 2u);
  EXPECT_EQ(count(document, "<table>"), 2u * 4u) << "trees and three ray types for each scene";
  EXPECT_EQ(count(document, "<tbody>"), count(document, "<table>"));
  EXPECT_NE(document.find("data-charts-drawn=\"6\""), std::string::npos)
      << "three for each scene, none of them blank";
  EXPECT_NE(document.find("data-pictures-shown=\"16\""), std::string::npos)
      << "two for each builder and scene";
  EXPECT_EQ(count(document, "class=\"legend\""), 2u);
  EXPECT_EQ(count(document, "class=\"card\""), 2u);
  EXPECT_EQ(count(document, "hits of all builders agree"), 2u);
  for (const char* fact :
       {"Processor", "Threads", "Versions", "kerf compare sticks:detail=0.02", "Surface area heuristic"}) {
    EXPECT_NE(document.find(fact), std::string::npos) << fact;
  }
}

TEST_F(ReportInBrowser, SweepShowsItsChartsAndATable) {
  const std::string document = make_and_open("sweep sticks:detail=0.02 --alphas 1,1e-3,0");
  EXPECT_EQ(count(document, "<table>"), 1u);
  EXPECT_NE(document.find("data-charts-drawn=\"2\""), std::string::npos);
  EXPECT_NE(document.find("data-pictures-shown=\"6\""), std::string::npos);
}

TEST_F(ReportInBrowser, AFileNameCannotInjectMarkup) {
  const std::string name = directory_.file("<img src=x onerror=alert(1)>.obj");
  write_bytes(name, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string document = make_and_open("compare '" + name + "' --builders bvh");
  EXPECT_EQ(document.find("<img src=\"x\""), std::string::npos);
  EXPECT_NE(document.find("data-pictures-shown=\"2\""), std::string::npos);
}

}  // namespace
