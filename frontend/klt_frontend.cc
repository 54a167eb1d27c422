#include "frontend/klt_frontend.h"

#include <opencv2/video/tracking.hpp>

#include "frontend/grid_corners.h"
#include "frontend/observe.h"

namespace rgbd_pose {
namespace {

const cv::Size kWindow(15, 15);
constexpr int kMaxLevel = 3;  // coarsest pyramid level, 80 x 60 of 640 x 480
const cv::TermCriteria kTermination(cv::TermCriteria::COUNT +
                                        cv::TermCriteria::EPS,
                                    10, 0.03);

// Localisation noise of a tracked corner per image: together 0.7 px.
constexpr double kSigmaPx = 0.5;

// A mean grey difference over the window beyond this is another place.
constexpr float kMaxMeanDifference = 25.0F;

struct KltFeatures : FeatureSet {
  std::vector<cv::Mat> pyramid;  // with derivatives
  std::vector<cv::Point2f> corners;
};

}  // namespace

KltFrontend::KltFrontend(const FrontendOptions& options)
    : options_(options),
      depth_options_{options.depth_noise, options.min_depth,
                     options.max_depth} {}

void KltFrontend::Prepare(Frame* frame) const {
  cv::buildOpticalFlowPyramid(frame->gray, frame->pyramid, kWindow, kMaxLevel,
                              /*withDerivatives=*/false);
}

std::unique_ptr<FeatureSet> KltFrontend::Detect(const Frame& frame) {
  auto features = std::make_unique<KltFeatures>();
  cv::buildOpticalFlowPyramid(frame.gray, features->pyramid, kWindow,
                              kMaxLevel);
  features->corners = DetectGridCorners(
      frame.gray, options_.max_features, [&](const cv::Point2f& pixel) {
        return LookUpDepth(frame, pixel.x, pixel.y, depth_options_).depth > 0.0;
      });
  for (const cv::Point2f& corner : features->corners) {
    features->observations.push_back(Observe(
        frame, options_.camera, corner.x, corner.y, kSigmaPx, depth_options_));
  }
  return features;
}

void KltFrontend::Match(const FeatureSet& reference, const Frame& frame,
                        const Rigid3d& cur_from_ref_guess,
                        FeatureMatches* matches) {
  matches->Clear();
  const auto& features = static_cast<const KltFeatures&>(reference);
  if (features.corners.empty()) return;
  if (frame.pyramid.empty()) {
    cv::buildOpticalFlowPyramid(frame.gray, pyramid_, kWindow, kMaxLevel,
                                /*withDerivatives=*/false);
  }
  tracked_ = features.corners;
  const Correspondences& camera = matches->matches;
  for (size_t i = 0; i < tracked_.size(); ++i) {
    const Eigen::Vector3d point =
        cur_from_ref_guess * camera.Point(features.observations[i]);
    if (point.z() < options_.min_depth) continue;
    const Eigen::Vector2d pixel = options_.camera.Project(point);
    tracked_[i] = cv::Point2f(static_cast<float>(pixel.x()),
                              static_cast<float>(pixel.y()));
  }
  cv::calcOpticalFlowPyrLK(
      features.pyramid, frame.pyramid.empty() ? pyramid_ : frame.pyramid,
      features.corners, tracked_, found_, error_, kWindow, kMaxLevel,
      kTermination, cv::OPTFLOW_USE_INITIAL_FLOW);
  for (size_t i = 0; i < tracked_.size(); ++i) {
    const Eigen::Vector2d pixel(tracked_[i].x, tracked_[i].y);
    if (found_[i] == 0 || error_[i] > kMaxMeanDifference ||
        !options_.camera.Contains(pixel)) {
      continue;
    }
    matches->Add(reference, static_cast<int>(i),
                 Observe(frame, options_.camera, pixel.x(), pixel.y(), kSigmaPx,
                         depth_options_));
  }
}

}  // namespace rgbd_pose
