// The report as a reader sees it: opened in a real browser, its pictures decoded, its charts laid out.
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

// Says in the root element what a reader would see, since the page itself runs no script: how many pictures
// were decoded, how many charts have an extent, and how much stands out beyond the window.
constexpr std::string_view probe = R"(<script>
addEventListener('load', () => {
  const page = document.documentElement;
  page.dataset.picturesShown = [...document.images].filter((image) => image.complete && image.naturalWidth > 0).length;
  page.dataset.chartsDrawn = [...document.querySelectorAll('figure.chart svg')].filter((chart) =>
    chart.getBBox().width > 300 && chart.getBBox().height > 200 && chart.querySelectorAll('rect, circle').length > 3).length;
  page.dataset.named = [...document.querySelectorAll('[role=img], img')].filter((element) => element.tagName === 'IMG'
    ? element.alt.length > 8
    : element.getAttribute('aria-labelledby').split(' ').every((id) => document.getElementById(id).textContent.length > 3)).length;
  page.dataset.outside = Math.max(0, page.scrollWidth - page.clientWidth);
});
</script>)";

// The document, with what the probe found.
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

    EXPECT_EQ(source.find("<script>"), std::string::npos) << "tables, charts and pictures need no script";
    EXPECT_NE(source.find("default-src 'none'"), std::string::npos) << "nothing may be loaded";

    // With the probe in it the page may run scripts.
    std::string probed = source;
    const std::string policy = "style-src 'unsafe-inline'";
    probed.replace(probed.find(policy), policy.size(), policy + "; script-src 'unsafe-inline'");
    probed.replace(probed.find("</head>"), 0, std::string(probe));
    const std::string document =
        open_in_browser(directory_.write("probed.html", probed), directory_.file("profile"));
    EXPECT_NE(document.find("data-outside=\"0\""), std::string::npos) << "something is wider than the window";
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
  EXPECT_NE(document.find("data-pictures-shown=\"10\""), std::string::npos)
      << "one of each scene, and one for each builder";
  EXPECT_NE(document.find("data-named=\"16\""), std::string::npos) << "every picture and chart has a text";
  EXPECT_NE(document.find("Turned by 30 degrees"), std::string::npos) << "rotate=30 is explained";
  EXPECT_NE(document.find("million rays per second"), std::string::npos) << "axes have titles with units";
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
  EXPECT_NE(document.find("data-pictures-shown=\"4\""), std::string::npos);
}

TEST_F(ReportInBrowser, AFileNameCannotInjectMarkup) {
  const std::string name = directory_.file("<img src=x onerror=alert(1)>.obj");
  write_bytes(name, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string document = make_and_open("compare '" + name + "' --builders bvh");
  EXPECT_EQ(document.find("<img src=\"x\""), std::string::npos);
  EXPECT_NE(document.find("data-pictures-shown=\"2\""), std::string::npos);
}

}  // namespace
