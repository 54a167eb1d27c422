#include "apps/figures/svg_chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "apps/figures/chart_axis.h"
#include "core/util/format.h"

namespace rgbd_pose {
namespace {

constexpr int kColumns = 2;

// Margins and sizes around the panels, px.
constexpr int kLeft = 74;
constexpr int kRight = 16;
constexpr int kTop = 30;
constexpr int kBottom = 50;
constexpr int kTitle = 34;
constexpr int kLegendRow = 20;
constexpr int kLegendColumn = 170;

constexpr int kTitleLetter = 9;

std::string Text(double x, double y, const std::string& style,
                 const std::string& text) {
  return Format("<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, style.c_str()) +
         EscapeMarkup(text) + "</text>\n";
}

std::string LineStyle(const ChartSeries& series) {
  std::string style =
      Format("fill=\"none\" stroke=\"%s\" stroke-width=\"%.1f\"",
             series.style.colour.c_str(), series.width_px);
  if (!series.style.dash.empty()) {
    style += " stroke-dasharray=\"" + series.style.dash + "\"";
  }
  return style;
}

std::string Marker(const SeriesStyle& style, double x, double y) {
  // Closed shapes around the point.
  constexpr const char* kShapes[kNumMarkers] = {
      "m-3 0a3 3 0 1 0 6 0a3 3 0 1 0 -6 0", "m-2.7 -2.7h5.4v5.4h-5.4z",
      "m0 -3.8l3.8 3.8l-3.8 3.8l-3.8 -3.8z", "m0 -3.6l3.6 6h-7.2z",
      "m0 3.6l3.6 -6h-7.2z"};
  if (style.marker < 0) return "";
  return Format("<path d=\"M%.1f %.1f%s\" fill=\"%s\"/>\n", x, y,
                kShapes[style.marker % kNumMarkers], style.colour.c_str());
}

// The position on the axis; not finite if y cannot be shown.
double AxisY(const ChartPanel& panel, double y) {
  return panel.log_y ? std::log10(y) : y;
}

struct Ranges {
  AxisRange x, y;
};

Ranges RangesOf(const std::vector<ChartPanel>& panels) {
  std::vector<double> x, y;
  for (const ChartPanel& panel : panels) {
    for (const ChartSeries& series : panel.series) {
      for (const ChartPoint& point : series.points) {
        if (!std::isfinite(AxisY(panel, point.y))) continue;
        x.push_back(point.x);
        y.push_back(AxisY(panel, point.y));
        if (point.high <= point.low) continue;
        y.push_back(AxisY(panel, point.low));
        y.push_back(AxisY(panel, point.high));
      }
    }
  }
  return {RangeOf(x), RangeOf(y)};
}

class Drawing {
 public:
  explicit Drawing(const Chart& chart) : chart_(chart) {
    cell_width_ = kLeft + chart.panel_width_px + kRight;
    cell_height_ = kTop + chart.panel_height_px + kBottom;
    width_ = kColumns * cell_width_;
    per_row_ = std::max(1, (width_ - kLeft) / kLegendColumn);
    const int labels = static_cast<int>(chart.panels[0].series.size());
    top_ = kTitle + kLegendRow * ((labels + per_row_ - 1) / per_row_);
  }

  std::string Draw() {
    const int rows =
        (static_cast<int>(chart_.panels.size()) + kColumns - 1) / kColumns;
    const int height = top_ + rows * cell_height_;
    text_ = Format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
        "viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" font-size=\"12\" "
        "fill=\"#222\">\n<rect width=\"100%%\" height=\"100%%\" "
        "fill=\"#fff\"/>\n",
        width_, height, width_, height);
    text_ += Text(kLeft, 22, "font-size=\"15\"", Title());
    DrawLegend();
    for (size_t i = 0; i < chart_.panels.size(); ++i) {
      left_ = static_cast<int>(i) % kColumns * cell_width_ + kLeft;
      upper_ = static_cast<int>(i) / kColumns * cell_height_ + top_ + kTop;
      DrawPanel(chart_.panels[i]);
    }
    return text_ + "</svg>\n";
  }

 private:
  // Long folder names are cut at the start, because they differ at their ends.
  std::string Title() const {
    const size_t fits = static_cast<size_t>((width_ - kLeft) / kTitleLetter);
    const std::string& title = chart_.title;
    return title.size() <= fits
               ? title
               : "..." + title.substr(title.size() - (fits - 3));
  }

  double PixelX(double x) const {
    return left_ + chart_.panel_width_px * ranges_.x.Share(x);
  }
  // `y` is an axis position: a logarithm on logarithmic axes.
  double PixelY(double y) const {
    return upper_ + chart_.panel_height_px * (1.0 - ranges_.y.Share(y));
  }

  void DrawLegend() {
    int i = 0;
    for (const ChartSeries& series : chart_.panels[0].series) {
      const int x = kLeft + i % per_row_ * kLegendColumn;
      const int y = kTitle + i / per_row_ * kLegendRow + 8;
      text_ += Format("<path d=\"M%d %dh26\" %s/>\n", x, y,
                      LineStyle(series).c_str());
      text_ += Marker(series.style, x + 13, y);
      text_ += Text(x + 32, y + 4, "", series.label);
      ++i;
    }
  }

  void FindRanges(const ChartPanel& panel) {
    std::vector<ChartPanel> alike;
    for (const ChartPanel& other : chart_.panels) {
      if (other.y_label == panel.y_label) alike.push_back(other);
    }
    ranges_ = RangesOf(alike);
    if (!panel.is_map) return;
    double scale = 0.0;
    for (const ChartPanel& other : chart_.panels) {
      if (!other.is_map) continue;
      const Ranges own = RangesOf({other});
      scale = std::max({scale, own.x.span() / chart_.panel_width_px,
                        own.y.span() / chart_.panel_height_px});
    }
    const auto around = [scale](const AxisRange& own, int pixels) {
      const double middle = (own.low + own.high) / 2.0;
      return AxisRange{middle - scale * pixels / 2.0,
                       middle + scale * pixels / 2.0};
    };
    ranges_ = {around(ranges_.x, chart_.panel_width_px),
               around(ranges_.y, chart_.panel_height_px)};
  }

  void DrawPanel(const ChartPanel& panel) {
    FindRanges(panel);
    const int right = left_ + chart_.panel_width_px;
    const int lower = upper_ + chart_.panel_height_px;
    for (const AxisTick& tick : LinearTicks(ranges_.x)) {
      const double x = PixelX(tick.place);
      text_ += Format("<path d=\"M%.1f %dV%d\" stroke=\"#ddd\"/>\n", x, upper_,
                      lower);
      text_ += Text(x, lower + 17, "text-anchor=\"middle\"",
                    Format("%.4g", tick.value));
    }
    for (const AxisTick& tick :
         panel.log_y ? LogTicks(ranges_.y) : LinearTicks(ranges_.y)) {
      const double y = PixelY(tick.place);
      text_ += Format("<path d=\"M%d %.1fH%d\" stroke=\"#ddd\"/>\n", left_, y,
                      right);
      text_ += Text(left_ - 6, y + 4, "text-anchor=\"end\"",
                    Format("%.4g", tick.value));
    }
    for (const ChartSeries& series : panel.series) DrawBand(panel, series);
    for (const ChartSeries& series : panel.series) DrawLine(panel, series);
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

  void DrawBand(const ChartPanel& panel, const ChartSeries& series) {
    std::string upper_edge, lower_edge;
    for (const ChartPoint& p : series.points) {
      if (!(p.high > p.low)) continue;
      upper_edge +=
          Format("%.1f,%.1f ", PixelX(p.x), PixelY(AxisY(panel, p.high)));
      lower_edge =
          Format("%.1f,%.1f ", PixelX(p.x), PixelY(AxisY(panel, p.low))) +
          lower_edge;
    }
    if (upper_edge.empty()) return;
    text_ += "<polygon points=\"" + upper_edge + lower_edge + "\" fill=\"" +
             series.style.colour + "\" fill-opacity=\"0.12\"/>\n";
  }

  void DrawLine(const ChartPanel& panel, const ChartSeries& series) {
    std::string line, markers;
    char step = 'M';
    for (const ChartPoint& p : series.points) {
      const double x = PixelX(p.x);
      const double y = PixelY(AxisY(panel, p.y));
      if (!std::isfinite(x) || !std::isfinite(y)) {
        step = 'M';
        continue;
      }
      line += Format("%c%.1f %.1f", step, x, y);
      markers += Marker(series.style, x, y);
      step = 'L';
    }
    if (line.empty()) return;
    text_ += "<path d=\"" + line + "\" " + LineStyle(series) + "/>\n" + markers;
  }

  const Chart& chart_;
  int cell_width_, cell_height_, width_, per_row_, top_;
  int left_ = 0, upper_ = 0;  // of the current panel
  Ranges ranges_;
  std::string text_;
};

}  // namespace

std::string EscapeMarkup(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    escaped += c == '&'   ? "&amp;"
               : c == '<' ? "&lt;"
               : c == '>' ? "&gt;"
                          : std::string(1, c);
  }
  return escaped;
}

SeriesStyle StyleOf(int i) {
  constexpr const char* kColours[] = {"#0072B2", "#D55E00", "#009E73",
                                      "#CC79A7", "#E69F00", "#56B4E9"};
  constexpr const char* kDashes[] = {"", "7 3", "2 2", "8 3 2 3"};
  return {kColours[i % std::size(kColours)], kDashes[i % std::size(kDashes)],
          i % kNumMarkers};
}

std::string FormatSvg(const Chart& chart) { return Drawing(chart).Draw(); }

}  // namespace rgbd_pose
