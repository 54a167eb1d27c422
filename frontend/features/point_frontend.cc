#include "frontend/features/point_frontend.h"

#include <string>

#include "core/util/input_error.h"
#include "frontend/features/grid_selection.h"
#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// Localisation noise of a point per image: 0.7 px for both images together.
constexpr double kPointSigmaPx = 0.5;

struct PointFeatures : FeatureSet {
  PreparedFrame frame;  // a copy
};

}  // namespace

std::unique_ptr<FeatureSet> PointFrontend::Detect(const PreparedFrame& frame) {
  auto features = std::make_unique<PointFeatures>();
  Points points;
  Find(frame, &points);
  for (const cv::Point2f& point : points) {
    AddFeature(frame, point, kPointSigmaPx, features.get());
    if (features->observations.back().depth > 0.0) continue;
    features->points.pop_back();
    features->observations.pop_back();
  }
  Frame copy = frame;
  copy.gray = frame.gray.clone();
  copy.depth.release();
  features->frame = PreparedFrame(copy);
  return features;
}

void PointFrontend::Match(const FeatureSet& reference,
                          const PreparedFrame& frame,
                          const Rigid3d& cur_from_ref_guess,
                          FeatureMatches* matches) {
  matches->Clear();
  const auto& features = static_cast<const PointFeatures&>(reference);
  if (features.points.empty()) return;
  Points moved = features.points;
  const FrameTiming timing = frame.Timing();
  for (size_t i = 0; i < moved.size(); ++i) {
    const Observation& ref = features.observations[i];
    const Eigen::Vector3d point = cur_from_ref_guess * PointOf(ref);
    if (ref.depth == 0.0 || point.z() < options_.depth.min_depth) continue;
    const Eigen::Vector2d pixel = ImagePoint(options_.camera, timing, point);
    moved[i] = cv::Point2d(pixel.x(), pixel.y());
  }
  Found found(moved.size(), 1);
  Follow(features.frame, features.points, frame, &moved, &found);
  const size_t count = features.points.size();
  if (moved.size() != count || found.size() != count) {
    throw InputError("a frontend returned " + std::to_string(moved.size()) +
                     " points and " + std::to_string(found.size()) +
                     " flags for " + std::to_string(count) + " points");
  }
  for (size_t i = 0; i < moved.size(); ++i) {
    if (found[i] == 0 || !options_.camera.Contains({moved[i].x, moved[i].y})) {
      continue;
    }
    matches->Add(reference, static_cast<int>(i),
                 ObserveAt(frame, moved[i], kPointSigmaPx));
  }
}

void PointFrontend::Find(const Frame& frame, Points* points) {
  *points = DetectGridCorners(frame, options_.max_features, options_.depth);
}

}  // namespace rgbd_pose
