#include "frontend/features/klt_frontend.h"

#include <opencv2/video/tracking.hpp>

namespace rgbd_pose {
namespace {

const cv::Size kWindow(15, 15);
constexpr int kMaxLevel = 3;  // coarsest pyramid level, 80 x 60 of 640 x 480
const cv::TermCriteria kTermination(cv::TermCriteria::COUNT +
                                        cv::TermCriteria::EPS,
                                    10, 0.03);

// A mean grey difference over the window beyond this is another place.
constexpr float kMaxMeanDifference = 25.0F;

}  // namespace

void KltFrontend::Prepare(Frame* frame) const {
  cv::buildOpticalFlowPyramid(frame->gray, frame->pyramid, kWindow, kMaxLevel,
                              /*withDerivatives=*/false);
}

void KltFrontend::PrepareReference(Frame* frame) const {
  frame->pyramid.clear();  // may be shared with the frame it is a copy of
  cv::buildOpticalFlowPyramid(frame->gray, frame->pyramid, kWindow, kMaxLevel);
}

void KltFrontend::Follow(const Frame& from, const Points& points,
                         const Frame& to, Points* moved, Found* found) {
  if (to.pyramid.empty()) {
    cv::buildOpticalFlowPyramid(to.gray, pyramid_, kWindow, kMaxLevel,
                                /*withDerivatives=*/false);
  }
  cv::calcOpticalFlowPyrLK(from.pyramid,
                           to.pyramid.empty() ? pyramid_ : to.pyramid, points,
                           *moved, *found, error_, kWindow, kMaxLevel,
                           kTermination, cv::OPTFLOW_USE_INITIAL_FLOW);
  for (size_t i = 0; i < found->size(); ++i) {
    if (error_[i] > kMaxMeanDifference) (*found)[i] = 0;
  }
}

}  // namespace rgbd_pose
