#include "apps/results/tracking_pictures.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "frontend/frame/image_pyramid.h"

namespace rgbd_pose {
namespace {

// Dark enough for every colour of the map to stand out, light enough to show
// the image at the features.
constexpr double kDimming = 0.45;

const cv::Scalar kNoWeightColor = cv::Scalar::all(200);
const cv::Scalar kStripColor = cv::Scalar::all(24);
const cv::Scalar kTextColor = cv::Scalar::all(235);

// Returns the colours of the weights from 0 to 1, in one row. Their lightness
// also increases, which shows the order to readers with any colour vision. The
// darkest part of the map is left out: it would be invisible on the image.
cv::Mat WeightColors() {
  constexpr int kFirst = 88;
  cv::Mat steps(1, 256 - kFirst, CV_8UC1);
  std::iota(steps.begin<uchar>(), steps.end<uchar>(), uchar{kFirst});
  cv::Mat colors;
  cv::applyColorMap(steps, colors, cv::COLORMAP_PLASMA);
  return colors;
}

cv::Scalar ColorAt(const cv::Mat& colors, double weight) {
  const double place = std::clamp(weight, 0.0, 1.0) * (colors.cols - 1);
  return colors.at<cv::Vec3b>(cvRound(place));
}

// The rows of text below an image: the caption, then the legend.
struct Strip {
  int width;  // of the image, px

  // Thickness of lines and letters, px; all grows with widths above 640 px.
  int unit = std::max(1, width / 640);
  int margin = 6 * unit;
  int row_height = 18 * unit;
  int row_width = std::max(1, width - 2 * margin);
  double font_scale = 0.42 * unit;  // the smallest that is easy to read

  // 80 average characters have a width of 600 in this font.
  int caption_rows = (600 * unit + row_width - 1) / row_width;
  cv::Mat image = cv::Mat((caption_rows + 1) * row_height + margin, width,
                          CV_8UC3, kStripColor);

  // Writes the words that fit into each row: at least a character.
  void DrawCaption(std::string caption) {
    for (int row = 0; row < caption_rows && !caption.empty(); ++row) {
      size_t end = caption.size();
      while (end > 1 && TextWidth(caption.substr(0, end)) > row_width) --end;
      const size_t space = caption.rfind(' ', end);
      if (end < caption.size() && space != std::string::npos && space > 0) {
        end = space;
      }
      PutText(caption.substr(0, end), margin, row);
      caption.erase(0, caption.find_first_not_of(' ', end));
    }
  }

  void DrawLegend(const cv::Mat& colors) {
    const int row = caption_rows;
    const std::string low = "robust weight  0";
    PutText(low, margin, row);
    const int x = 2 * margin + TextWidth(low);
    const cv::Size bar(80 * unit, row_height / 2);
    const int right = x + bar.width + margin;
    const std::string high_and_key =
        "1     dot: feature now, line: from the reference";
    const bool has_room = right + TextWidth(high_and_key) <= width;
    PutText(has_room ? high_and_key : "1", right, row);
    for (int i = 0; i < bar.width; ++i) {
      const double weight = i / (bar.width - 1.0);
      cv::line(image, {x + i, Baseline(row) - bar.height},
               {x + i, Baseline(row)}, ColorAt(colors, weight));
    }
  }

  // The y coordinate of the baseline of a row.
  int Baseline(int row) const { return (row + 1) * row_height - margin / 2; }

  int TextWidth(const std::string& text) const {
    return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, font_scale, unit,
                           nullptr)
        .width;
  }

  void PutText(const std::string& text, int x, int row) {
    cv::putText(image, text, {x, Baseline(row)}, cv::FONT_HERSHEY_SIMPLEX,
                font_scale, kTextColor, unit, cv::LINE_AA);
  }
};

// OpenCV draws to fractions of a pixel in fixed point: here 1/16 px.
constexpr int kShift = 4;
int Fixed(double px) { return cvRound(px * (1 << kShift)); }

// Returns the place of an observation in the distorted image, in fixed point.
cv::Point ImagePoint(const Camera& camera, const Observation& o) {
  const Eigen::Vector2d pixel = camera.Project(camera.Ray(o.u, o.v));
  // Limits points far outside, which would not fit into an int.
  constexpr double kFarPx = 1e5;
  const Eigen::Vector2d near = pixel.cwiseMax(-kFarPx).cwiseMin(kFarPx);
  return {Fixed(near.x()), Fixed(near.y())};
}

}  // namespace

cv::Mat DrawMatches(const Frame& frame, const Camera& camera,
                    const FeatureMatches& found, const MotionEstimate& estimate,
                    const std::string& caption) {
  Strip strip{frame.gray.cols};
  const double dot_radius = std::max(1.5, 2.5 * strip.width / 640);
  const cv::Mat colors = WeightColors();
  cv::Mat image;
  cv::cvtColor(frame.gray * kDimming, image, cv::COLOR_GRAY2BGR);

  const Correspondences& matches = found.matches;
  const bool has_weights = estimate.weights.size() == matches.size();
  const std::vector<double> weights =
      has_weights ? estimate.weights : std::vector<double>(matches.size(), 0.0);
  std::vector<size_t> order(matches.size());  // the smallest weight first
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return weights[a] < weights[b]; });
  for (const size_t i : order) {
    const cv::Scalar color =
        has_weights ? ColorAt(colors, weights[i]) : kNoWeightColor;
    const cv::Point prev = ImagePoint(camera, matches[i].prev);
    const cv::Point cur = ImagePoint(camera, matches[i].cur);
    cv::line(image, prev, cur, color, strip.unit, cv::LINE_AA, kShift);
    cv::circle(image, cur, Fixed(dot_radius), color, cv::FILLED, cv::LINE_AA,
               kShift);
  }

  strip.DrawCaption(caption);
  strip.DrawLegend(colors);
  cv::Mat picture;
  cv::vconcat(image, strip.image, picture);
  return picture;
}

cv::Mat DrawResiduals(const FrameView& reference, const Frame& frame,
                      const Rigid3d& cur_from_ref) {
  constexpr double kFullColor = 20.0;  // grey levels
  // Grey levels that agree use the lower half of the scale: colours stand out.
  constexpr double kDimmed = 0.5;
  const auto& [gray, camera] = reference.levels[1];
  // Where the frame sees each pixel of the reference, both at level 1: px.
  cv::Mat places(gray.height, gray.width, CV_32FC2, cv::Scalar::all(-1.0));
  cv::Mat valid(places.size(), CV_8UC1, cv::Scalar(0));
  for (int v = 0; v < places.rows; ++v) {
    for (int u = 0; u < places.cols; ++u) {
      const double depth = reference.DepthAt(2 * u + 1, 2 * v + 1);
      if (depth <= 0.0) continue;
      const Eigen::Vector3d point =
          cur_from_ref * camera.Unproject(Eigen::Vector2d(u, v), depth);
      if (!(point.z() > 0.0)) continue;
      const Eigen::Vector2d pixel = camera.Project(point);
      if (!camera.Contains(pixel)) continue;
      places.at<cv::Vec2f>(v, u) = {static_cast<float>(pixel.x()),
                                    static_cast<float>(pixel.y())};
      valid.at<uint8_t>(v, u) = 255;
    }
  }
  const SmoothPyramid pyramid{PreparedFrame(frame)};
  cv::Mat seen;
  cv::remap(pyramid.levels[1], seen, places, cv::Mat(), cv::INTER_LINEAR);
  const cv::Mat before(gray.height, gray.width, CV_8UC1,
                       const_cast<uint8_t*>(gray.data), gray.stride);
  cv::Scalar mean_before, deviation_before, mean_now, deviation_now;
  cv::meanStdDev(before, mean_before, deviation_before, valid);
  cv::meanStdDev(seen, mean_now, deviation_now, valid);
  const double gain =
      deviation_before[0] > 1.0 ? deviation_now[0] / deviation_before[0] : 1.0;
  cv::Mat picture(places.size(), CV_8UC3, cv::Scalar::all(0));
  for (int v = 0; v < places.rows; ++v) {
    for (int u = 0; u < places.cols; ++u) {
      if (valid.at<uint8_t>(v, u) == 0) continue;
      const double now = seen.at<uint8_t>(v, u);
      const double expected =
          mean_now[0] + gain * (before.at<uint8_t>(v, u) - mean_before[0]);
      const double off = std::clamp((now - expected) / kFullColor, -1.0, 1.0);
      const double plain = kDimmed * now * (1.0 - std::abs(off));
      const cv::Vec3d color(plain + 255.0 * std::max(0.0, -off), plain,
                            plain + 255.0 * std::max(0.0, off));
      picture.at<cv::Vec3b>(v, u) = color;
    }
  }
  return picture;
}

}  // namespace rgbd_pose
