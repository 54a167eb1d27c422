// A frontend of your own: strong corners, followed by optical flow.
#include <cstdio>
#include <opencv2/video/tracking.hpp>

#include "rgbd_pose/costs/cost_factory.h"
#include "rgbd_pose/frontend/features/point_frontend.h"
#include "rgbd_pose/frontend/settings/settings.h"
#include "rgbd_pose/frontend/simulation/synthetic_dataset.h"
#include "rgbd_pose/frontend/tracking/feature_tracker.h"
#include "rgbd_pose/frontend/tracking/odometry.h"

struct Flow final : rgbd_pose::PointFrontend {
  using PointFrontend::PointFrontend;
  void Find(const rgbd_pose::Frame& frame, Points* points) override {
    cv::goodFeaturesToTrack(frame.gray, *points, 400, 0.01, 10.0);
  }
  void Follow(const rgbd_pose::PreparedFrame& from, const Points& points,
              const rgbd_pose::PreparedFrame& to, Points* moved,
              Found* found) override {
    cv::calcOpticalFlowPyrLK(from.gray, to.gray, points, *moved, *found, {});
  }
};

int main() {
  const rgbd_pose::SyntheticDataset room({"room", "pan_tilt", 60});  // or yours
  const auto options = rgbd_pose::FeaturesFor({}, room.camera());
  rgbd_pose::Odometry odometry(
      {}, std::make_unique<rgbd_pose::FeatureTracker>(
              std::make_unique<Flow>(options),
              rgbd_pose::Estimator({}, rgbd_pose::MakeRobustCosts())));
  for (int i = 0; i < room.size(); ++i) odometry.Track(room.Read(i));
  std::printf("error %.4f m\n", odometry.WorldFromCam().translation.norm());
}
