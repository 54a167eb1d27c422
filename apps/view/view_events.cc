#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/view/view_state.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "frontend/files/jpeg_codec.h"
#include "frontend/files/png_codec.h"

namespace rgbd_pose {
namespace {

// Widths of the images on the page, px.
constexpr double kGrayWidth = 640.0;
constexpr double kDepthWidth = 320.0;

// Depth step, m. 255 steps reach beyond 10 m.
constexpr double kDepthStep = 0.04;

std::string Event(const char* name, const std::string& json) {
  return Format("event: %s\ndata: ", name) + json + "\n\n";
}

std::string Text(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', /*ensure_ascii=*/true,
                                   nlohmann::json::error_handler_t::replace);
}

template <typename Items, typename FormatItem>
std::string List(const Items& items, const FormatItem& format) {
  std::vector<std::string> texts;
  for (const auto& item : items) texts.push_back(format(item));
  return "[" + Join(texts, ",") + "]";
}

std::string FormatPose(const Rigid3d& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return Format("%.4f,%.4f,%.4f,%.5f,%.5f,%.5f,%.5f", t.x(), t.y(), t.z(),
                q.x(), q.y(), q.z(), q.w());
}

std::string FormatFrame(const ViewFrame& frame) {
  return Format("[%.3f,%d,%.2f,%d,%d,%.3f,%d,", frame.timestamp,
                static_cast<int>(frame.status), frame.track_ms, frame.matches,
                frame.inliers, frame.sigma, frame.segment) +
         Text(frame.reason) + "," +
         (frame.keyframe.has_value() ? Format("%d,", *frame.keyframe) +
                                           FormatPose(frame.keyframe_from_cam)
                                     : "null") +
         "]";
}

cv::Mat Narrowed(const cv::Mat& image, double width, int interpolation) {
  const double scale = width / image.cols;
  if (scale >= 1.0) return image;
  cv::Mat small;
  cv::resize(image, small, {}, scale, scale, interpolation);
  return small;
}

}  // namespace

std::string FormatNews(const ViewNews& news) {
  std::string json =
      "{\"frames\":" + List(news.frames, FormatFrame) + ",\"keyframes\":" +
      List(news.keyframes,
           [](const ViewKeyframe& keyframe) {
             return Format("[%d,\"", keyframe.id) + Base64(keyframe.points) +
                    "\"]";
           }) +
      ",\"links\":" +
      List(news.links,
           [](const MapEdge& link) {
             return Format("[%d,%d,%d]", link.ref, link.cur, link.is_loop);
           }) +
      ",\"poses\":" +
      List(news.poses,
           [](const auto& pose) {
             return Format("[%d,", pose.first) + FormatPose(pose.second) + "]";
           }) +
      ",\"paused\":" + (news.is_paused ? "true" : "false") + "}";
  std::string events = Event("news", json);
  if (news.is_finished) events += Event("end", Text(news.results));
  return events;
}

std::string FormatImages(const ViewImages& images, int index) {
  const std::string jpeg =
      EncodeJpeg(Narrowed(images.gray, kGrayWidth, cv::INTER_AREA), 75);
  cv::Mat steps;
  const cv::Mat depth = Narrowed(images.depth, kDepthWidth, cv::INTER_NEAREST);
  depth.convertTo(steps, CV_8U, 1.0 / (images.depth_scale * kDepthStep));
  steps.setTo(0, depth == Frame::kNoDepth);
  return Event(
      "images",
      Format("{\"index\":%d,\"width\":%d,\"height\":%d,\"depth_step\":%g,",
             index, images.gray.cols, images.gray.rows, kDepthStep) +
          "\"gray\":\"" + Base64(jpeg) + "\",\"depth\":\"" +
          Base64(EncodePng(steps)) + "\",\"matches\":" +
          List(images.moves,
               [](const cv::Vec<float, 5>& move) {
                 return Format("[%.1f,%.1f,%.1f,%.1f,%.2f]", move[0], move[1],
                               move[2], move[3], move[4]);
               }) +
          "}");
}

}  // namespace rgbd_pose
