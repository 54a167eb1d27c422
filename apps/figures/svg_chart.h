#pragma once

#include <string>
#include <vector>

namespace rgbd_pose {

struct ChartPoint {
  double x = 0.0;
  double y = 0.0;
  // What y may be as well; drawn as a band where high > low.
  double low = 0.0;
  double high = 0.0;
};

// How the i-th of several lines looks: colours that colour-blind people tell
// apart (Okabe & Ito 2008, without black and yellow), and dashes and markers
// besides. All of the first twelve differ.
struct SeriesStyle {
  std::string colour = "#000000";  // "#rrggbb"
  std::string dash;                // lengths in pixels; empty: none
  int marker = -1;                 // of kNumMarkers shapes; -1: none
};
SeriesStyle StyleOf(int i);
constexpr int kNumMarkers = 5;

// A line of a panel.
struct ChartSeries {
  std::string label;
  SeriesStyle style;
  double width_px = 1.5;
  // Where x or y is NaN, or y <= 0 on a logarithmic axis, the line has a gap.
  std::vector<ChartPoint> points;
};

struct ChartPanel {
  std::string title;
  std::string x_label;  // with its unit
  std::string y_label;
  std::vector<ChartSeries> series;
  bool log_y = false;
  // As many units a pixel on both axes, and in all such panels of a chart.
  bool is_map = false;
};

// Panels, two side by side, below one legend, which is that of the first panel,
// or with the names of lines at their ends.
struct Chart {
  std::string title;
  std::vector<ChartPanel> panels;
  int panel_width_px = 360;
  int panel_height_px = 360;
  bool same_ranges = false;  // of all panels that are no maps
  bool label_lines = false;
};

// A text as the content of an element of SVG or HTML.
std::string EscapeMarkup(const std::string& text);

// The chart as a file of SVG 1.1.
std::string FormatSvg(const Chart& chart);

}  // namespace rgbd_pose
