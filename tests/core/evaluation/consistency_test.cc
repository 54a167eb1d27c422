#include "core/evaluation/consistency.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace rgbd_pose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kChiTolerance = 1e-9;

Rigid3d Pose(double angle, const Vector3d& place) {
  return Rigid3d(Quaterniond(AngleAxisd(angle, Vector3d(1, 2, 3).normalized())),
                 place);
}

// A motion with exactly this error, as MotionEstimate defines it.
RelativePose WithError(const Rigid3d& truth, const MotionVector& error) {
  const Vector3d turn = error.head<3>();
  RelativePose edge;
  edge.cur_from_ref.rotation =
      Quaterniond(AngleAxisd(turn.norm(), turn.normalized())).conjugate() *
      truth.rotation;
  const Vector3d centre = truth.Inverse().translation - error.tail<3>();
  edge.cur_from_ref.translation = -(edge.cur_from_ref.rotation * centre);
  return edge;
}

TEST(ConsistencyTest, ChiSquareIsOfTheErrorAsCovariancesHaveIt) {
  const Rigid3d truth = Pose(0.4, {0.3, -0.2, 0.1});
  MotionVector error;
  error << 0.01, -0.02, 0.03, 0.004, 0.005, -0.006;
  RelativePose edge = WithError(truth, error);
  edge.covariance = 1e-4 * MotionMatrix::Identity();
  edge.covariance(0, 3) = edge.covariance(3, 0) = 4e-5;
  EXPECT_NEAR(ChiSquare(edge, truth, {}),
              error.dot(edge.covariance.inverse() * error), kChiTolerance);
  const MotionMatrix covariance = edge.covariance;
  const TruthNoise noise = {0.002, 0.003};
  edge.covariance.topLeftCorner<3, 3>() += 9e-6 * Eigen::Matrix3d::Identity();
  edge.covariance.bottomRightCorner<3, 3>() +=
      4e-6 * Eigen::Matrix3d::Identity();
  const double expected = ChiSquare(edge, truth, {});
  edge.covariance = covariance;
  EXPECT_NEAR(ChiSquare(edge, truth, noise), expected, kChiTolerance);
}

TEST(ConsistencyTest, CountsWhatIsBeyondFiveSigmas) {
  const Trajectory truth = {{0.0, Pose(0.1, {0, 0, 0})},
                            {0.03, Pose(0.2, {0, 0.1, 0})},
                            {1.0, Pose(0.3, {0, 0.2, 0})}};
  // The last time is in a gap of the truth.
  const std::vector<double> times = {0.0, 0.015, 0.03, 0.5};
  const Rigid3d motion =
      truth[1].world_from_cam.Inverse() * truth[0].world_from_cam;
  std::vector<RelativePose> edges;
  for (const double chi_square : {6.0, 40.0, 42.0}) {
    MotionVector error = MotionVector::Zero();
    error[4] = 1e-3 * std::sqrt(chi_square);
    edges.push_back(WithError(motion, error));
    edges.back().ref = 0;
    edges.back().cur = 2;
    edges.back().covariance = 1e-6 * MotionMatrix::Identity();
  }
  edges.push_back(edges.front());
  edges.back().covariance.setZero();  // covariance unknown
  edges.push_back(edges.front());
  edges.back().cur = 3;
  const Consistency all = Judge(edges, times, truth, {});
  EXPECT_EQ(all.count, 3);
  EXPECT_EQ(all.wrong, 1);
  EXPECT_NEAR(all.nees, (6.0 + 40.0 + 42.0) / 18.0, 1e-6);
  EXPECT_NEAR(all.median, 40.0 / 6.0, 1e-6);

  // Half-way between two poses of the truth, by interpolation.
  edges.resize(1);
  edges[0].cur = 1;
  EXPECT_EQ(Judge(edges, times, truth, {}).wrong, 1);
  edges.clear();
  EXPECT_EQ(Judge(edges, times, truth, {}).count, 0);
}

// A frame that was tracked against a keyframe of a loaded map.
TEST(ConsistencyTest, LeavesOutWhatIsNoFrame) {
  const Trajectory truth = {{0.0, Rigid3d()}, {0.03, Rigid3d()}};
  RelativePose edge;
  edge.covariance = 1e-6 * MotionMatrix::Identity();
  std::vector<RelativePose> edges(3, edge);
  edges[0].cur = 1;
  edges[1].ref = -500000000;
  edges[2].cur = 2;
  EXPECT_EQ(Judge(edges, {0.0, 0.03}, truth, {}).count, 1);
}

}  // namespace
}  // namespace rgbd_pose
