// The charts of a report, as SVG in the page: they need no script, and print as they stand.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace workbench {

/// The bars of one colour, or one line.
struct ChartSeries {
  std::string name;
  std::string style;           ///< class of its colour: `bvh`, `sbvh`, ... or `c0` to `c6`
  std::vector<double> values;  ///< one for each group or place
  /// Stacked on `values`, in a lighter colour; empty for none.
  std::vector<double> above = {};
  /// The end of a whisker at each bar; empty for none.
  std::vector<double> whiskers = {};
};

struct Chart {
  std::string id;                   ///< of the element, unlike any other in the page
  std::string title;                ///< plain text, as are all below
  std::string remark;               ///< behind the title, in a lighter letter
  std::string x_title, y_title;     ///< with units
  std::vector<std::string> places;  ///< groups of bars, or places along a line
  std::vector<ChartSeries> series;
};

/// A figure with the title and grouped bars from 0 up. Its text alternative has all values.
std::string html_bars(const Chart& chart);

/// The same with lines between points.
std::string html_lines(const Chart& chart);

}  // namespace workbench
