#include "frontend/places/relocaliser.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/initial_guess/ransac.h"
#include "frontend/features/descriptor_matching.h"
#include "frontend/features/descriptor_method.h"
#include "frontend/features/grid_selection.h"
#include "frontend/image/observe.h"

namespace rgbd_pose {
namespace {

// The caller keeps about as many keyframes to go on from.
constexpr size_t kMaxPlaces = 20;

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

Observation ObserveKeypoint(const Frame& frame, const Camera& camera,
                            const cv::KeyPoint& keypoint,
                            const DepthLookupOptions& depth_options) {
  return Observe(frame, camera, keypoint.pt.x, keypoint.pt.y,
                 Orb().SigmaPx(keypoint), depth_options);
}

}  // namespace

struct Relocaliser::Place {
  int id = 0;
  Frame frame;  // its images are let go once it is described
  bool is_described = false;
  DescribedKeypoints described;
  std::vector<Observation> observations;  // of each keypoint

  void Describe(const Camera& camera, const DepthLookupOptions& depth_options);
};

void Relocaliser::Place::Describe(const Camera& camera,
                                  const DepthLookupOptions& depth_options) {
  const DescribedKeypoints all = DescribeImage(frame.gray);
  described = all.Select(SelectOverGrid(
      all.keypoints, frame.gray.size(), kMaxFeatures,
      [&](const cv::Point2f& pixel) {
        return LookUpDepth(frame, pixel.x, pixel.y, depth_options).depth > 0.0;
      }));
  for (const cv::KeyPoint& keypoint : described.keypoints) {
    observations.push_back(
        ObserveKeypoint(frame, camera, keypoint, depth_options));
  }
  frame = Frame();
  is_described = true;
}

Relocaliser::Relocaliser(const Camera& camera,
                         const DepthLookupOptions& depth_options)
    : camera_(camera), depth_options_(depth_options) {}

Relocaliser::~Relocaliser() = default;
Relocaliser::Relocaliser(Relocaliser&&) noexcept = default;
Relocaliser& Relocaliser::operator=(Relocaliser&&) noexcept = default;

void Relocaliser::Add(const Frame& keyframe, int id) {
  auto place = std::make_unique<Place>();
  place->id = id;
  place->frame = keyframe;
  place->frame.gray = keyframe.gray.clone();
  place->frame.depth = keyframe.depth.clone();
  places_.push_front(std::move(place));
  if (places_.size() > kMaxPlaces) places_.pop_back();
  next_ = 1;
}

std::optional<Relocalisation> Relocaliser::Find(const Frame& frame) {
  const DescribedKeypoints current = DescribeImage(frame.gray);
  RansacOptions ransac;
  ransac.consensus.min_inliers = kMinInliers;
  ransac.consensus.min_inlier_share = kMinInlierShare;
  size_t descriptions = 0;
  for (size_t look = 0; look < std::min(kMaxLooks, places_.size()); ++look) {
    // The latest, and those whose turn it is.
    const size_t at = look == 0 ? 0 : next_;
    Place& place = *places_[at];
    if (!place.is_described) {
      if (++descriptions > kMaxDescriptions) break;
      place.Describe(camera_, depth_options_);
    }
    if (look > 0 && ++next_ >= places_.size()) next_ = 1;
    Correspondences matches(camera_);
    for (const KeypointMatch& match :
         MatchKeypoints(Orb(), place.described, current, nullptr)) {
      matches.Add(
          place.observations[match.reference],
          ObserveKeypoint(frame, camera_, current.keypoints[match.current],
                          depth_options_));
    }
    if (const std::optional<Consensus> found = FindByRansac(matches, ransac)) {
      return Relocalisation{place.id, found->cur_from_prev,
                            static_cast<int>(found->inliers.size())};
    }
  }
  return std::nullopt;
}

}  // namespace rgbd_pose
