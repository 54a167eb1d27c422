#include "apps/svg_chart.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace rgbd_pose {
namespace {

// Around panels, in pixels.
constexpr int kLeft = 74;
constexpr int kRight = 16;
constexpr int kTop = 30;
constexpr int kBottom = 50;
constexpr int kTitle = 34;
constexpr int kLegendRow = 20;
constexpr int kLegendColumn = 170;

struct Range {
  double low = 0.0;
  double high = 1.0;
  double Share(double value) const { return (value - low) / (high - low); }
};

[[gnu::format(printf, 1, 2)]] std::string Format(const char* format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof(text), format, arguments);
  va_end(arguments);
  return text;
}

std::string Escape(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    escaped += c == '&'   ? "&amp;"
               : c == '<' ? "&lt;"
               : c == '>' ? "&gt;"
                          : std::string(1, c);
  }
  return escaped;
}

std::string Text(double x, double y, const std::string& style,
                 const std::string& text) {
  return Format("<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, style.c_str()) +
         Escape(text) + "</text>\n";
}

std::string LineStyle(const ChartSeries& series) {
  return Format("fill=\"none\" stroke=\"%s\" stroke-width=\"%.1f\"%s",
                series.colour.c_str(), series.width_px,
                series.is_dashed ? " stroke-dasharray=\"6 3\"" : "");
}

// The range of all values of one axis of some panels, with some room.
template <typename Values>
Range RangeOf(const std::vector<ChartPanel>& panels, const Values& values) {
  Range range = {INFINITY, -INFINITY};
  for (const ChartPanel& panel : panels) {
    for (const ChartSeries& series : panel.series) {
      for (const ChartPoint& point : series.points) {
        for (const double value : values(point)) {
          range.low = std::min(range.low, value);
          range.high = std::max(range.high, value);
        }
      }
    }
  }
  if (!(range.low <= range.high)) return {};
  if (range.low == range.high) return {range.low - 0.5, range.high + 0.5};
  const double room = 0.04 * (range.high - range.low);
  return {range.low - room, range.high + room};
}

class Drawing {
 public:
  explicit Drawing(const Chart& chart) : chart_(chart) {
    cell_width_ = kLeft + chart.panel_width_px + kRight;
    cell_height_ = kTop + chart.panel_height_px + kBottom;
    width_ = chart.columns * cell_width_;
    per_row_ = std::max(1, (width_ - kLeft) / kLegendColumn);
    const int labels = chart.panels.empty()
                           ? 0
                           : static_cast<int>(chart.panels[0].series.size());
    top_ = kTitle + kLegendRow * ((labels + per_row_ - 1) / per_row_);
  }

  std::string Draw() {
    const int rows =
        (static_cast<int>(chart_.panels.size()) + chart_.columns - 1) /
        chart_.columns;
    const int height = top_ + rows * cell_height_;
    text_ = Format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
        "viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" font-size=\"12\" "
        "fill=\"#222\">\n<rect width=\"100%%\" height=\"100%%\" "
        "fill=\"#fff\"/>\n",
        width_, height, width_, height);
    text_ += Text(kLeft, 22, "font-size=\"15\"", chart_.title);
    DrawLegend();
    for (size_t i = 0; i < chart_.panels.size(); ++i) {
      left_ = static_cast<int>(i) % chart_.columns * cell_width_ + kLeft;
      upper_ =
          static_cast<int>(i) / chart_.columns * cell_height_ + top_ + kTop;
      DrawPanel(chart_.panels[i]);
    }
    return text_ + "</svg>\n";
  }

 private:
  double Y(double y) const { return chart_.log_y ? std::log10(y) : y; }

  double PixelX(double x) const {
    return left_ + chart_.panel_width_px * x_.Share(x);
  }
  // Of a value of the axis: the logarithm where that counts.
  double PixelY(double y) const {
    return upper_ + chart_.panel_height_px * (1.0 - y_.Share(y));
  }

  void DrawLegend() {
    if (chart_.panels.empty()) return;
    int i = 0;
    for (const ChartSeries& series : chart_.panels[0].series) {
      const int x = kLeft + i % per_row_ * kLegendColumn;
      const int y = kTitle + i / per_row_ * kLegendRow + 8;
      text_ += Format("<path d=\"M%d %dh26\" %s/>\n", x, y,
                      LineStyle(series).c_str());
      text_ += Text(x + 32, y + 4, "", series.label);
      ++i;
    }
  }

  void FindRanges(const ChartPanel& panel) {
    const auto x = [](const ChartPoint& p) { return std::vector{p.x}; };
    const auto y = [this](const ChartPoint& p) {
      if (p.high <= p.low) return std::vector{Y(p.y)};
      return std::vector{Y(p.y), Y(p.low), Y(p.high)};
    };
    x_ = RangeOf(chart_.panels, x);
    y_ = RangeOf(chart_.panels, y);
    if (!chart_.same_scale) return;
    double scale = 0.0;
    for (const ChartPanel& other : chart_.panels) {
      const Range wide = RangeOf({other}, x);
      const Range tall = RangeOf({other}, y);
      scale = std::max({scale, (wide.high - wide.low) / chart_.panel_width_px,
                        (tall.high - tall.low) / chart_.panel_height_px});
    }
    const auto around = [scale](const Range& own, int pixels) {
      const double middle = (own.low + own.high) / 2.0;
      return Range{middle - scale * pixels / 2.0,
                   middle + scale * pixels / 2.0};
    };
    x_ = around(RangeOf({panel}, x), chart_.panel_width_px);
    y_ = around(RangeOf({panel}, y), chart_.panel_height_px);
  }

  // Steps of 1, 2 or 5 times a power of ten, some four to eight an axis.
  static double TicStep(const Range& range) {
    const double span = range.high - range.low;
    const double power = std::pow(10.0, std::floor(std::log10(span)));
    if (span < 1.5 * power) return 0.2 * power;
    if (span < 3.5 * power) return 0.5 * power;
    return span < 7.0 * power ? power : 2.0 * power;
  }

  void DrawPanel(const ChartPanel& panel) {
    FindRanges(panel);
    const int right = left_ + chart_.panel_width_px;
    const int lower = upper_ + chart_.panel_height_px;
    const double x_step = TicStep(x_);
    for (double i = std::ceil(x_.low / x_step); i * x_step <= x_.high; ++i) {
      const double x = PixelX(i * x_step);
      text_ += Format("<path d=\"M%.1f %dV%d\" stroke=\"#ddd\"/>\n", x, upper_,
                      lower);
      text_ += Text(x, lower + 17, "text-anchor=\"middle\"",
                    Format("%.4g", i * x_step + 0.0));
    }
    const double y_step = chart_.log_y ? 1.0 : TicStep(y_);
    for (double i = std::ceil(y_.low / y_step); i * y_step <= y_.high; ++i) {
      const double y = PixelY(i * y_step);
      text_ += Format("<path d=\"M%d %.1fH%d\" stroke=\"#ddd\"/>\n", left_, y,
                      right);
      const double value = chart_.log_y ? std::pow(10.0, i) : i * y_step;
      text_ += Text(left_ - 6, y + 4, "text-anchor=\"end\"",
                    Format("%.4g", value + 0.0));
    }
    for (const ChartSeries& series : panel.series) DrawSeries(series);
    text_ +=
        Format("<path d=\"M%d %dV%dH%d\" fill=\"none\" stroke=\"#444\"/>\n",
               left_, upper_, lower, right);
    text_ += Text(left_, upper_ - 8, "font-weight=\"bold\"", panel.title);
    text_ += Text((left_ + right) / 2.0, lower + 36, "text-anchor=\"middle\"",
                  panel.x_label);
    const double middle = (upper_ + lower) / 2.0;
    text_ += Text(left_ - 52, middle,
                  Format("text-anchor=\"middle\" transform=\"rotate(-90 %d "
                         "%.1f)\"",
                         left_ - 52, middle),
                  panel.y_label);
  }

  void DrawSeries(const ChartSeries& series) {
    std::string line, upper_edge, lower_edge;
    for (const ChartPoint& p : series.points) {
      line += Format("%.1f,%.1f ", PixelX(p.x), PixelY(Y(p.y)));
      if (p.high <= p.low) continue;
      upper_edge += Format("%.1f,%.1f ", PixelX(p.x), PixelY(Y(p.high)));
      lower_edge =
          Format("%.1f,%.1f ", PixelX(p.x), PixelY(Y(p.low))) + lower_edge;
    }
    if (!upper_edge.empty()) {
      text_ += "<polygon points=\"" + upper_edge + lower_edge + "\" fill=\"" +
               series.colour + "\" fill-opacity=\"0.2\"/>\n";
    }
    text_ += "<polyline points=\"" + line + "\" " + LineStyle(series) + "/>\n";
  }

  const Chart& chart_;
  int cell_width_, cell_height_, width_, per_row_, top_;
  int left_ = 0, upper_ = 0;  // of the panel
  Range x_, y_;
  std::string text_;
};

}  // namespace

std::string SeriesColour(int i) {
  constexpr const char* kColours[kNumSeriesColours] = {
      "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"};
  return kColours[i % kNumSeriesColours];
}

std::string FormatSvg(const Chart& chart) { return Drawing(chart).Draw(); }

}  // namespace rgbd_pose
