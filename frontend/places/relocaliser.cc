#include "frontend/places/relocaliser.h"

#include <algorithm>

#include "core/initial_guess/ransac.h"
#include "frontend/features/descriptor_method.h"
#include "frontend/features/grid_selection.h"
#include "frontend/image/observe.h"

namespace rgbd_pose {
namespace {

// What one search may do: describing an image takes about 7 ms, looking at a
// described one 2 ms.
constexpr size_t kMaxLooks = 5;
constexpr size_t kMaxDescriptions = 2;

// Detected in a frame; of them, kept of a keyframe: spread over the image and
// with a depth.
constexpr int kMaxKeypoints = 1500;
constexpr int kMaxFeatures = 400;

// A motion is believed with so many inliers, in number and as a share of the
// matches. Of the matches between different places fewer than 6 agree on a
// motion, as three points fix it and a fourth agrees by chance once in some
// thousand; the rest is a margin for texture that repeats itself.
constexpr int kMinInliers = 15;
constexpr double kMinInlierShare = 0.3;

DescribedKeypoints DescribeImage(const cv::Mat& gray) {
  DescribedKeypoints all;
  Orb()
      .make(kMaxKeypoints)
      ->detectAndCompute(gray, cv::noArray(), all.keypoints, all.descriptors);
  return all;
}

}  // namespace

Place::Place(const Frame& keyframe, int id) : id_(id), frame_(keyframe) {
  frame_.gray = keyframe.gray.clone();
  frame_.depth = keyframe.depth.clone();
}

void Relocaliser::Describe(Place* place) const {
  const Frame& frame = place->frame_;
  const DescribedKeypoints all = DescribeImage(frame.gray);
  place->described_ = all.Select(SelectOverGrid(
      all.keypoints, frame.gray.size(), kMaxFeatures,
      [&](const cv::Point2f& pixel) {
        return LookUpDepth(frame, pixel.x, pixel.y, depth_options_).depth > 0.0;
      }));
  for (const cv::KeyPoint& keypoint : place->described_.keypoints) {
    place->observations_.push_back(ObserveKeypoint(frame, keypoint));
  }
  place->frame_ = Frame();
  place->is_described_ = true;
}

Observation Relocaliser::ObserveKeypoint(const Frame& frame,
                                         const cv::KeyPoint& keypoint) const {
  return Observe(frame, camera_, keypoint.pt.x, keypoint.pt.y,
                 Orb().SigmaPx(keypoint), depth_options_);
}

std::optional<Relocalisation> Relocaliser::Find(
    const Frame& frame, const std::vector<Place*>& places) {
  if (places.empty()) return std::nullopt;
  if (places.front()->id_ != latest_id_ || next_ >= places.size()) next_ = 1;
  latest_id_ = places.front()->id_;
  const DescribedKeypoints current = DescribeImage(frame.gray);
  RansacOptions ransac;
  ransac.consensus.min_inliers = kMinInliers;
  ransac.consensus.min_inlier_share = kMinInlierShare;
  size_t descriptions = 0;
  for (size_t look = 0; look < std::min(kMaxLooks, places.size()); ++look) {
    // The latest, and those whose turn it is.
    const size_t at = look == 0 ? 0 : next_;
    Place& place = *places[at];
    if (!place.is_described_) {
      if (++descriptions > kMaxDescriptions) break;
      Describe(&place);
    }
    if (look > 0 && ++next_ >= places.size()) next_ = 1;
    Correspondences matches(camera_);
    for (const KeypointMatch& match :
         MatchKeypoints(Orb(), place.described_, current, nullptr)) {
      matches.Add(place.observations_[match.reference],
                  ObserveKeypoint(frame, current.keypoints[match.current]));
    }
    if (const std::optional<Consensus> found = FindByRansac(matches, ransac)) {
      return Relocalisation{place.id_, found->cur_from_prev,
                            static_cast<int>(found->inliers.size())};
    }
  }
  return std::nullopt;
}

}  // namespace rgbd_pose
