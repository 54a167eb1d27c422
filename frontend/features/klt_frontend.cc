#include "frontend/features/klt_frontend.h"

#include <opencv2/core.hpp>
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

struct KltFrame final : PreparedFrame {
  KltFrame(const Frame& frame, bool with_derivatives) : PreparedFrame(frame) {
    cv::buildOpticalFlowPyramid(gray, pyramid, kWindow, kMaxLevel,
                                with_derivatives);
  }
  std::unique_ptr<PreparedFrame> Copy() const override {
    return std::make_unique<KltFrame>(*this);
  }

  std::vector<cv::Mat> pyramid;
};

}  // namespace

std::unique_ptr<const PreparedFrame> KltFrontend::Prepare(
    const Frame& frame) const {
  return std::make_unique<KltFrame>(frame, /*with_derivatives=*/false);
}

std::unique_ptr<const PreparedFrame> KltFrontend::PrepareReference(
    const Frame& frame) const {
  return std::make_unique<KltFrame>(frame, /*with_derivatives=*/true);
}

void KltFrontend::Follow(const PreparedFrame& from, const Points& points,
                         const PreparedFrame& to, Points* moved, Found* found) {
  cv::calcOpticalFlowPyrLK(dynamic_cast<const KltFrame&>(from).pyramid,
                           dynamic_cast<const KltFrame&>(to).pyramid, points,
                           *moved, *found, error_, kWindow, kMaxLevel,
                           kTermination, cv::OPTFLOW_USE_INITIAL_FLOW);
  for (size_t i = 0; i < found->size(); ++i) {
    if (error_[i] > kMaxMeanDifference) (*found)[i] = 0;
  }
}

}  // namespace rgbd_pose
