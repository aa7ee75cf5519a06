#include "workbench/report/charts.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "workbench/report/html.hpp"

namespace workbench {
namespace {

// Units of the picture, which the page scales.
constexpr double width = 420.0, height = 300.0;
constexpr double left = 52.0, right = 412.0, top = 12.0, bottom = 206.0;  // of the area of values
constexpr double legend_top = 262.0, legend_row = 18.0;

std::string short_number(double value) {
  return fmt::format("{:.4g}", value);
}

// From 0 to a round number, in four to six steps.
struct Scale {
  double end, step;

  explicit Scale(double largest) {
    const double rough = std::max(largest, 1e-12) / 5.0;
    const double decade = std::pow(10.0, std::floor(std::log10(rough)));
    step = 10.0 * decade;
    for (const double round : {5.0, 2.5, 2.0, 1.0}) {
      if (round * decade >= rough) step = round * decade;
    }
    end = step * std::ceil(largest / step - 1e-9);
    if (!(end > 0.0)) end = step;
  }
  double y(double value) const { return bottom - (bottom - top) * value / end; }
};

double largest_value(const Chart& chart) {
  double largest = 0.0;
  for (const ChartSeries& series : chart.series) {
    for (std::size_t i = 0; i < series.values.size(); ++i)
      largest = std::max(largest, series.values[i] + (series.above.empty() ? 0.0 : series.above[i]));
    for (const double end : series.whiskers) largest = std::max(largest, end);
  }
  return largest;
}

// What a reader hears who does not see the picture.
std::string description(const Chart& chart) {
  std::string text;
  for (std::size_t place = 0; place < chart.places.size(); ++place) {
    text += chart.places[place] + ": ";
    for (const ChartSeries& series : chart.series) {
      text += fmt::format("{}{} {}", &series == &chart.series.front() ? "" : ", ", series.name,
                          short_number(series.values[place]));
      if (!series.above.empty()) text += " + " + short_number(series.above[place]);
    }
    text += ". ";
  }
  return text;
}

std::string begin(const Chart& chart) {
  return fmt::format(
      "<figure class=\"chart\"><figcaption>{1} <small>{2}</small></figcaption>\n"
      "<svg id=\"{0}\" role=\"img\" aria-labelledby=\"{0}-title {0}-text\" viewBox=\"0 0 {3} {4}\">\n"
      "<title id=\"{0}-title\">{1}</title>\n<desc id=\"{0}-text\">{5}: {6}</desc>\n",
      chart.id, escape_html(chart.title), escape_html(chart.remark), width, height,
      escape_html(chart.y_title), escape_html(description(chart)));
}

std::string axes(const Chart& chart, const Scale& scale) {
  std::string text;
  for (double value = 0.0; value <= scale.end * (1.0 + 1e-9); value += scale.step) {
    const double y = scale.y(value);
    text += fmt::format(
        "<path class=\"grid\" d=\"M{0} {2:.1f}H{1}\"/><text class=\"end\" x=\"{3}\" "
        "y=\"{4:.1f}\">{5}</text>\n",
        left, right, y, left - 6.0, y + 4.0, short_number(value));
  }
  const double place_width = (right - left) / static_cast<double>(chart.places.size());
  for (std::size_t i = 0; i < chart.places.size(); ++i) {
    text += fmt::format("<text class=\"middle\" x=\"{:.1f}\" y=\"{}\">{}</text>\n",
                        left + place_width * (static_cast<double>(i) + 0.5), bottom + 16.0,
                        escape_html(chart.places[i]));
  }
  return text + fmt::format(
                    "<text class=\"middle\" x=\"{}\" y=\"{}\">{}</text>\n"
                    "<text class=\"middle\" transform=\"translate(12 {}) rotate(-90)\">{}</text>\n",
                    0.5 * (left + right), bottom + 36.0, escape_html(chart.x_title), 0.5 * (top + bottom),
                    escape_html(chart.y_title));
}

std::string legend(const Chart& chart) {
  std::string text;
  double x = left, y = legend_top;
  for (const ChartSeries& series : chart.series) {
    const double room = 26.0 + 6.6 * static_cast<double>(series.name.size());
    if (x + room > right) x = left, y += legend_row;
    text += fmt::format(
        "<rect class=\"{}\" x=\"{:.1f}\" y=\"{}\" width=\"12\" height=\"12\"/><text x=\"{:.1f}\" "
        "y=\"{}\">{}</text>\n",
        series.style, x, y, x + 17.0, y + 10.5, escape_html(series.name));
    x += room;
  }
  return text;
}

std::string bar(std::string_view style, double x, double breadth, double from, double to,
                const std::string& name) {
  return fmt::format(
      "<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
      "height=\"{:.1f}\"><title>{}</title></rect>\n",
      style, x, to, breadth, std::max(from - to, 0.0), escape_html(name));
}

}  // namespace

std::string html_bars(const Chart& chart) {
  const Scale scale(largest_value(chart));
  std::string text = begin(chart) + axes(chart, scale);
  const double group = (right - left) / static_cast<double>(chart.places.size());
  const double breadth = 0.8 * group / static_cast<double>(chart.series.size());
  for (std::size_t place = 0; place < chart.places.size(); ++place) {
    for (std::size_t s = 0; s < chart.series.size(); ++s) {
      const ChartSeries& series = chart.series[s];
      const double x = left + group * (static_cast<double>(place) + 0.1) + breadth * static_cast<double>(s);
      const double value = series.values[place];
      const std::string name =
          fmt::format("{}, {}: {}", chart.places[place], series.name, short_number(value));
      text += bar(series.style, x, 0.9 * breadth, bottom, scale.y(value), name);
      if (!series.above.empty()) {
        const double above = series.above[place];
        text += bar(series.style + " light", x, 0.9 * breadth, scale.y(value), scale.y(value + above),
                    name + " + " + short_number(above));
      }
      if (!series.whiskers.empty()) {
        text += fmt::format("<path class=\"whisker\" d=\"M{0:.1f} {1:.1f}V{2:.1f}M{3:.1f} {2:.1f}h6\"/>\n",
                            x + 0.45 * breadth, scale.y(value), scale.y(series.whiskers[place]),
                            x + 0.45 * breadth - 3.0);
      }
    }
  }
  return text + fmt::format("<path class=\"axis\" d=\"M{} {}H{}\"/>\n", left, bottom, right) + legend(chart) +
         "</svg></figure>\n";
}

std::string html_lines(const Chart& chart) {
  const Scale scale(largest_value(chart));
  std::string text = begin(chart) + axes(chart, scale);
  const double step = (right - left) / static_cast<double>(chart.places.size());
  for (const ChartSeries& series : chart.series) {
    std::string path, points;
    for (std::size_t i = 0; i < series.values.size(); ++i) {
      const double x = left + step * (static_cast<double>(i) + 0.5), y = scale.y(series.values[i]);
      path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", x, y);
      points += fmt::format(
          "<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\"><title>{}</title></circle>\n",
          series.style, x, y,
          escape_html(
              fmt::format("{}, {}: {}", chart.places[i], series.name, short_number(series.values[i]))));
    }
    text += fmt::format("<path class=\"line {}\" d=\"{}\"/>\n{}", series.style, path, points);
  }
  return text + fmt::format("<path class=\"axis\" d=\"M{} {}H{}\"/>\n", left, bottom, right) + legend(chart) +
         "</svg></figure>\n";
}

}  // namespace workbench
