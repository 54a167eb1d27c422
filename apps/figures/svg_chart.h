#pragma once

#include <string>
#include <vector>

namespace rgbd_pose {

struct ChartPoint {
  double x = 0.0;
  double y = 0.0;
  // Uncertainty of y; drawn as a band if high > low.
  double low = 0.0;
  double high = 0.0;
};

// The style of the i-th of several lines. Colours are distinguishable for
// colour-blind people (Okabe & Ito 2008, without black and yellow); dashes and
// markers differ as well. The first twelve styles are all different.
struct SeriesStyle {
  std::string colour = "#000000";  // "#rrggbb"
  std::string dash;                // lengths in px; empty: solid
  int marker = -1;                 // one of kNumMarkers shapes; -1: none
};
SeriesStyle StyleOf(int i);
constexpr int kNumMarkers = 5;

// A line of a panel.
struct ChartSeries {
  std::string label;
  SeriesStyle style;
  double width_px = 1.5;
  // The line has a gap where x or y is NaN, or y <= 0 on a logarithmic axis.
  std::vector<ChartPoint> points = {};
};

struct ChartPanel {
  std::string title;
  std::string x_label;  // with unit
  std::string y_label;
  std::vector<ChartSeries> series = {};
  bool log_y = false;
  // Same scale on both axes, and in all such panels of a chart.
  bool is_map = false;
};

// Panels, two in a row, below a common legend (of the first panel). Panels with
// the same y_label have the same ranges.
struct Chart {
  std::string title;
  std::vector<ChartPanel> panels;  // at least one
  int panel_width_px = 360;
  int panel_height_px = 360;
};

// Escapes a text for an element of SVG or HTML.
std::string EscapeMarkup(const std::string& text);

std::string FormatSvg(const Chart& chart);

}  // namespace rgbd_pose
