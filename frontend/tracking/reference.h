#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/estimation/frame_view.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"
#include "frontend/frame/view_overlap.h"
#include "frontend/tracking/feature_validation.h"

namespace rgbd_pose {

// The features of a frame, and which of them may affect the motion.
struct ReferenceFeatures {
  // `validation` must be made for these features.
  ReferenceFeatures(const Camera& camera, std::unique_ptr<FeatureSet> features,
                    FeatureValidation validation)
      : camera(camera),
        features(std::move(features)),
        validation(std::move(validation)) {}

  // How much of them a camera should see after this motion.
  Overlap SeenFrom(const Rigid3d& cur_from_ref) const;

  Camera camera;                         // of the frame
  std::unique_ptr<FeatureSet> features;  // of the frame
  FeatureValidation validation;          // of the features
};

// The images of a frame for the direct costs. Shares their memory.
struct ReferencePixels {
  // `id`: unique for each frame and velocity, as costs keep its points.
  ReferencePixels(const PreparedFrame& frame, const FrontendOptions& images,
                  uint64_t id);

  cv::Mat depth;
  std::vector<cv::Mat> pyramid;
  FrameView view;
  ViewOverlap samples;  // pixels with depth on a grid over the image
};

// What tracking keeps of a frame that others are tracked against, and what it
// has learnt about this frame since. A tracker that uses only one of both
// leaves the other one null.
struct Reference {
  std::unique_ptr<ReferenceFeatures> features;
  std::unique_ptr<ReferencePixels> pixels;

  // How much of the reference a camera should see after this motion. At least
  // one of both must be there.
  Overlap SeenFrom(const Rigid3d& cur_from_ref) const {
    return features != nullptr ? features->SeenFrom(cur_from_ref)
                               : pixels->samples.SeenFrom(cur_from_ref);
  }
};

}  // namespace rgbd_pose
