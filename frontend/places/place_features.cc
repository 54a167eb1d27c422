#include "frontend/places/place_features.h"

#include "frontend/features/grid_selection.h"
#include "frontend/frame/observe.h"

namespace rgbd_pose {

PlaceFeatures DescribeKeyframe(const PreparedFrame& frame,
                               const FrontendOptions& images) {
  // Keypoints detected, and kept. With half as many, half as many pairs of real
  // keyframes are found to show the same place (docs/places.md).
  constexpr int kMaxKeypoints = 2000;
  constexpr int kMaxFeatures = 800;
  const auto& all = frame.Derived<DescribedKeypoints>(&kOrb, kMaxKeypoints);
  PlaceFeatures features;
  features.described = all.Select(
      SelectOverGrid(all.keypoints, frame, kMaxFeatures, images.depth));
  for (const cv::KeyPoint& keypoint : features.described.keypoints) {
    features.observations.push_back(
        Observe(frame, images.camera, keypoint.pt.x, keypoint.pt.y,
                kOrb.SigmaPx(keypoint), images.depth));
  }
  return features;
}

std::optional<Consensus> VerifyGeometrically(const PlaceFeatures& prev,
                                             const PlaceFeatures& cur,
                                             const Camera& camera) {
  // A motion is accepted with this many inliers and this share of the matches.
  // Between different places fewer than 6 matches agree on a motion; the rest
  // is a margin for repetitive texture.
  constexpr int kMinInliers = 10;
  constexpr double kMinInlierShare = 0.1;
  Correspondences matches(camera);
  for (const KeypointMatch& match :
       MatchKeypoints(kOrb, prev.described, cur.described, nullptr)) {
    matches.Add(prev.observations[match.reference],
                cur.observations[match.current]);
  }
  return FindByRansac(matches, {kMinInliers, kMinInlierShare});
}

}  // namespace rgbd_pose
