#include "frontend/features/descriptor_frontend.h"

#include <limits>
#include <utility>

#include "frontend/features/descriptor_matching.h"
#include "frontend/features/grid_selection.h"
#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// Number of keypoints detected per feature wanted. Textured places take most of
// the keypoints, and the ones of a reference have to be found again.
constexpr int kKeypointsPerFeature = 5;

// Search radius around the expected place of a keypoint, rad: turns of 200
// degrees per second at 30 frames per second without any prediction.
constexpr double kSearchAngle = 0.12;

// The guess was wrong if a smaller share of the features is found around it.
constexpr double kMinGuidedShare = 0.2;

struct DescribedFeatures : FeatureSet {
  DescribedKeypoints described;  // one row per observation
};

struct AllKeypoints {
  AllKeypoints(const PreparedFrame& frame, const DescriptorMethod* method,
               int max_keypoints) {
    // OpenCV does not state that a detector may be used by several threads.
    method->make(max_keypoints)
        ->detectAndCompute(frame.gray, cv::noArray(), described.keypoints,
                           described.descriptors);
  }
  DescribedKeypoints described;
};

}  // namespace

void DescriptorFrontend::Prepare(const PreparedFrame& frame) const {
  Keypoints(frame);
}

const DescribedKeypoints& DescriptorFrontend::Keypoints(
    const PreparedFrame& frame) const {
  return frame
      .Derived<AllKeypoints>(&method_,
                             kKeypointsPerFeature * options_.max_features)
      .described;
}

Observation DescriptorFrontend::ObserveKeypoint(
    const Frame& frame, const cv::KeyPoint& keypoint) const {
  return Observe(frame, options_.camera, keypoint.pt.x, keypoint.pt.y,
                 method_.SigmaPx(keypoint), depth_options_);
}

std::unique_ptr<FeatureSet> DescriptorFrontend::Detect(
    const PreparedFrame& frame) {
  const DescribedKeypoints& all = Keypoints(frame);
  auto features = std::make_unique<DescribedFeatures>();
  features->described = all.Select(SelectOverGrid(
      all.keypoints, frame.gray.size(), options_.max_features,
      [&](const cv::Point2f& pixel) {
        return LookUpDepth(frame, pixel.x, pixel.y, depth_options_).depth > 0.0;
      }));
  for (const cv::KeyPoint& keypoint : features->described.keypoints) {
    features->observations.push_back(ObserveKeypoint(frame, keypoint));
  }
  return features;
}

void DescriptorFrontend::Match(const FeatureSet& reference,
                               const PreparedFrame& frame,
                               const Rigid3d& cur_from_ref_guess,
                               FeatureMatches* matches) {
  matches->Clear();
  const auto& features = static_cast<const DescribedFeatures&>(reference);
  const DescribedKeypoints& current = Keypoints(frame);
  const FrameTiming timing = frame.Timing();
  SearchGuide guide;
  guide.radius_px = static_cast<float>(kSearchAngle * options_.camera.fx);
  for (const Observation& o : features.observations) {
    const Eigen::Vector3d point = cur_from_ref_guess * PointOf(o);
    Eigen::Vector2d pixel =
        Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    if (point.z() > 0.0) pixel = ImagePoint(options_.camera, timing, point);
    guide.expected.emplace_back(static_cast<float>(pixel.x()),
                                static_cast<float>(pixel.y()));
  }
  std::vector<KeypointMatch> found =
      MatchKeypoints(method_, features.described, current, &guide);
  if (found.size() < kMinGuidedShare * features.observations.size()) {
    std::vector<KeypointMatch> anywhere =
        MatchKeypoints(method_, features.described, current, nullptr);
    if (anywhere.size() > found.size()) found = std::move(anywhere);
  }
  for (const KeypointMatch& match : found) {
    matches->Add(reference, match.reference,
                 ObserveKeypoint(frame, current.keypoints[match.current]));
  }
}

}  // namespace rgbd_pose
