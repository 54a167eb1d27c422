#include "apps/view/view_state.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "core/util/format.h"
#include "frontend/frame/depth_warper.h"
#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// Maximum news per event, for pages that open late in a long run.
constexpr size_t kMaxFrames = 2000;
constexpr size_t kMaxKeyframes = 20;

// Points are thinned above this limit to keep drawing fluent.
constexpr size_t kMaxPointBytes = 200000 * kViewPointBytes;

// Copies at most `most` items after `at`.
template <typename T>
std::vector<T> TakeNew(const std::vector<T>& all, size_t most, size_t* at) {
  const auto begin = all.begin() + *at;
  *at = std::min(all.size(), *at + most);
  return {begin, all.begin() + *at};
}

template <typename T>
void Append(std::vector<T> more, std::vector<T>* all) {
  std::move(more.begin(), more.end(), std::back_inserter(*all));
}

// Number of sample points across the image: about 2,000 in total.
constexpr int kColumns = 53;

// Points beyond this depth (m) are left out as too inaccurate.
constexpr double kMaxDepth = 6.0;

}  // namespace

void ViewState::Add(ViewNews news) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const ViewKeyframe& keyframe : news.keyframes) {
      point_bytes_ += keyframe.points.size();
    }
    Append(std::move(news.frames), &all_.frames);
    Append(std::move(news.keyframes), &all_.keyframes);
    Append(std::move(news.links), &all_.links);
    if (!news.poses.empty()) {
      all_.poses = std::move(news.poses);
      ++poses_;
    }
    if (news.images.has_value()) {
      all_.images = std::move(news.images);
      all_.images_index = static_cast<int>(all_.frames.size()) - 1;
      ++images_;
    }
    // Points are in random order, so half of them show the same, only thinner.
    while (point_bytes_ > kMaxPointBytes) {
      point_bytes_ = 0;
      for (ViewKeyframe& keyframe : all_.keyframes) {
        const size_t points = keyframe.points.size() / kViewPointBytes;
        keyframe.points.resize(points / 2 * kViewPointBytes);
        point_bytes_ += keyframe.points.size();
      }
    }
  }
  changed_.notify_all();
}

template <typename Change>
void ViewState::Control(const Change& change) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    change();
    ++controls_;
  }
  changed_.notify_all();
}

void ViewState::Finish(const std::string& results) {
  Control([&] {
    all_.results = results;
    all_.is_finished = true;
    all_.is_paused = false;
  });
}

void ViewState::Pause(bool is_paused) {
  Control([&] { all_.is_paused = is_paused; });
}

void ViewState::Stop() {
  Control([&] {
    is_stopped_ = true;
    all_.is_paused = false;
  });
}

ViewNews ViewState::Next(std::chrono::milliseconds patience,
                         ViewCursor* cursor) {
  ViewNews news;
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait_for(lock, patience, [&] {
    return cursor->frames < all_.frames.size() || cursor->poses != poses_ ||
           cursor->keyframes < all_.keyframes.size() ||
           cursor->images != images_ || cursor->controls != controls_;
  });
  news.frames = TakeNew(all_.frames, kMaxFrames, &cursor->frames);
  news.keyframes = TakeNew(all_.keyframes, kMaxKeyframes, &cursor->keyframes);
  news.links = TakeNew(all_.links, all_.links.size(), &cursor->links);
  if (cursor->poses != poses_) news.poses = all_.poses;
  if (cursor->images != images_) news.images = all_.images;
  news.images_index = all_.images_index;
  news.is_paused = all_.is_paused;
  // The end is reported after all earlier news.
  news.is_finished = all_.is_finished && cursor->frames == all_.frames.size() &&
                     cursor->keyframes == all_.keyframes.size();
  news.results = all_.results;
  cursor->poses = poses_;
  cursor->images = images_;
  cursor->controls = controls_;
  return news;
}

bool ViewState::is_stopped() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return is_stopped_;
}

bool ViewState::is_paused() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return all_.is_paused;
}

void ViewState::WaitForControl(std::chrono::milliseconds patience) {
  std::unique_lock<std::mutex> lock(mutex_);
  const int before = controls_;
  changed_.wait_for(lock, patience, [&] { return controls_ != before; });
}

std::string SamplePoints(const Frame& frame, const cv::Mat& color,
                         const Camera& camera) {
  const bool has_color = color.size() == frame.gray.size();
  const int step = std::max(1, frame.gray.cols / kColumns);
  std::vector<cv::Point> pixels;
  for (int v = step / 2; v < frame.gray.rows; v += step) {
    for (int u = step / 2; u < frame.gray.cols; u += step) {
      pixels.emplace_back(u, v);
    }
  }
  std::shuffle(pixels.begin(), pixels.end(), std::mt19937(1));
  std::string bytes;
  for (const cv::Point& pixel : pixels) {
    const double depth = frame.DepthAt(pixel.x, pixel.y);
    if (!(depth > 0.0) || depth > kMaxDepth) continue;
    const Eigen::Vector2d ideal = camera.Undistort({pixel.x, pixel.y});
    const Eigen::Vector3d point = depth * camera.Ray(ideal.x(), ideal.y());
    if (!(point.cwiseAbs().maxCoeff() < 32.0)) continue;
    for (const double metres : {point.x(), point.y(), point.z()}) {
      AppendLittleEndian(static_cast<uint16_t>(
                             static_cast<int16_t>(std::lround(1e3 * metres))),
                         &bytes);
    }
    const cv::Vec3b bgr = has_color
                              ? color.at<cv::Vec3b>(pixel)
                              : cv::Vec3b::all(frame.gray.at<uint8_t>(pixel));
    for (const int channel : {2, 1, 0})
      bytes += static_cast<char>(bgr[channel]);
  }
  return bytes;
}

std::vector<cv::Vec<float, 5>> MatchesInImage(
    const Frame& frame, const Camera& camera, const Correspondences& matches,
    const std::vector<double>& weights) {
  const auto place = [&](const Observation& seen) {
    const double depth =
        seen.depth > 0.0 ? seen.depth : 1.0 / kRoomInverseDepth;
    return ImagePoint(camera, frame.Timing(),
                      camera.Ray(seen.u, seen.v) * depth);
  };
  std::vector<cv::Vec<float, 5>> moves;
  for (size_t i = 0; i < matches.size(); ++i) {
    const Eigen::Vector2f from = place(matches[i].prev).cast<float>();
    const Eigen::Vector2f to = place(matches[i].cur).cast<float>();
    const double weight = weights.size() == matches.size() ? weights[i] : -1.0;
    moves.emplace_back(from.x(), from.y(), to.x(), to.y(),
                       static_cast<float>(weight));
  }
  return moves;
}

}  // namespace rgbd_pose
