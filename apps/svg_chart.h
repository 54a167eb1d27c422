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

// A line of a panel.
struct ChartSeries {
  std::string label;
  std::string colour;  // "#rrggbb"
  bool is_dashed = false;
  double width_px = 1.5;
  std::vector<ChartPoint> points;
};

struct ChartPanel {
  std::string title;
  std::string x_label;  // with its unit
  std::string y_label;
  std::vector<ChartSeries> series;
};

// Panels side by side below one legend, which is that of the first panel: all
// have the same series. All panels have the same ranges, or with `same_scale`
// as many units a pixel on both axes of every panel, as maps do.
struct Chart {
  std::string title;
  std::vector<ChartPanel> panels;
  int columns = 2;
  int panel_width_px = 360;
  int panel_height_px = 360;
  bool log_y = false;  // y > 0 then
  bool same_scale = false;
};

// The i-th colour that colour-blind people tell apart (Okabe & Ito 2008,
// without black and yellow), from the start again after the last.
std::string SeriesColour(int i);
constexpr int kNumSeriesColours = 6;

// The chart as a file of SVG 1.1.
std::string FormatSvg(const Chart& chart);

}  // namespace rgbd_pose
