// The motion between two frames from matches of your own, a fifth of them
// wrong.
#include <cstdio>

#include "rgbd_pose/core/estimation/estimator.h"
#include "rgbd_pose/costs/cost_factory.h"

int main() {
  const rgbd_pose::Camera camera;  // yours: fx, fy, cx, cy in pixels
  const rgbd_pose::Rigid3d truth({0.999, 0.0, 0.04, 0.0}, {0.1, 0.0, -0.05});
  rgbd_pose::Correspondences matches(camera);
  for (int i = 0; i < 200; ++i) {
    const int row = i / 20;
    const Eigen::Vector3d prev(0.1 * (i % 20), 0.1 * row, 2.0 + i % 7);
    const Eigen::Vector3d cur = truth * prev * (i % 5 == 0 ? 1.3 : 1.0);
    const Eigen::Vector2d a = camera.Project(prev), b = camera.Project(cur);
    // Pixel, depth (m) and their standard deviations (px, m) in both frames.
    matches.Add({a.x(), a.y(), prev.z(), 0.5, 0.01},
                {b.x(), b.y(), cur.z(), 0.5, 0.01});
  }
  rgbd_pose::Estimator estimator({}, rgbd_pose::MakeRobustCosts());
  const rgbd_pose::MotionEstimate estimate = estimator.Estimate(matches);
  const auto error = estimate.cur_from_prev.Inverse() * truth;
  std::printf("%s, %d of %d matches agree, error %.3f mm\n",
              ToString(estimate.status), estimate.num_inliers,
              estimate.num_used, 1e3 * error.translation.norm());
  return estimate.ok() ? 0 : 1;
}
