#include <cmath>
#include <utility>

#include "frontend/features/descriptor_matching.h"
#include "frontend/features/frontend.h"
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

class DescriptorFrontend final : public Frontend {
 public:
  DescriptorFrontend(const FrontendOptions& options,
                     const DescriptorMethod& method)
      : Frontend(options), method_(method) {}

  bool is_exhaustive() const override { return false; }

  void Prepare(const PreparedFrame& frame) const override { Keypoints(frame); }

  std::unique_ptr<FeatureSet> Detect(const PreparedFrame& frame) override {
    const DescribedKeypoints& all = Keypoints(frame);
    auto features = std::make_unique<DescribedFeatures>();
    features->described = all.Select(SelectOverGrid(
        all.keypoints, frame, options_.max_features, options_.depth));
    for (const cv::KeyPoint& keypoint : features->described.keypoints) {
      AddFeature(frame, keypoint.pt, method_.SigmaPx(keypoint), features.get());
    }
    return features;
  }

  void Match(const FeatureSet& reference, const PreparedFrame& frame,
             const Rigid3d& cur_from_ref_guess,
             FeatureMatches* matches) override {
    matches->Clear();
    const auto& features = static_cast<const DescribedFeatures&>(reference);
    const DescribedKeypoints& current = Keypoints(frame);
    const FrameTiming timing = frame.Timing();
    SearchGuide guide;
    guide.radius_px = static_cast<float>(kSearchAngle * options_.camera.fx);
    for (const Observation& o : features.observations) {
      const Eigen::Vector3d point = cur_from_ref_guess * PointOf(o);
      Eigen::Vector2d pixel = Eigen::Vector2d::Constant(NAN);
      if (o.depth > 0.0 && point.z() > 0.0) {
        pixel = ImagePoint(options_.camera, timing, point);
      }
      guide.expected.push_back(cv::Point2d(pixel.x(), pixel.y()));
    }
    std::vector<KeypointMatch> found =
        MatchKeypoints(method_, features.described, current, &guide);
    if (found.size() < kMinGuidedShare * features.observations.size()) {
      std::vector<KeypointMatch> anywhere =
          MatchKeypoints(method_, features.described, current, nullptr);
      if (anywhere.size() > found.size()) found = std::move(anywhere);
    }
    for (const KeypointMatch& match : found) {
      const cv::KeyPoint& keypoint = current.keypoints[match.current];
      matches->Add(reference, match.reference,
                   ObserveAt(frame, keypoint.pt, method_.SigmaPx(keypoint)));
    }
  }

 private:
  const DescribedKeypoints& Keypoints(const PreparedFrame& frame) const {
    const int max_keypoints = kKeypointsPerFeature * options_.max_features;
    return frame.Derived<DescribedKeypoints>(&method_, max_keypoints);
  }

  const DescriptorMethod& method_;
};

}  // namespace

std::unique_ptr<Frontend> MakeDescriptorFrontend(
    const FrontendOptions& options, const DescriptorMethod& method) {
  return std::make_unique<DescriptorFrontend>(options, method);
}

}  // namespace rgbd_pose
