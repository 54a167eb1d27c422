#include "apps/results/slam_output.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/factors/relative_pose.h"
#include "core/factors/sqrt_information.h"
#include "tests/support/graph_world.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

// g2o's representation of a graph, read and solved without our code.
struct G2oPose {
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
};

// The error of EDGE_SE3:QUAT: [t, vec q] of measured^-1 * (X_i^-1 * X_j), with
// the quaternion's sign chosen for q_w >= 0.
struct G2oError {
  template <typename T>
  Eigen::Matrix<T, 6, 1> Of(const Eigen::Matrix<T, 3, 1>& t_i,
                            const Eigen::Quaternion<T>& q_i,
                            const Eigen::Matrix<T, 3, 1>& t_j,
                            const Eigen::Quaternion<T>& q_j) const {
    const Eigen::Quaternion<T> back = measured.q.cast<T>().conjugate();
    const Eigen::Matrix<T, 3, 1> t = q_i.conjugate() * (t_j - t_i);
    const Eigen::Quaternion<T> q = back * (q_i.conjugate() * q_j);
    Eigen::Matrix<T, 6, 1> e;
    e << back * (t - measured.t.cast<T>()), q.vec() * T(q.w() < 0.0 ? -1 : 1);
    return e;
  }

  template <typename T>
  bool operator()(const T* t_i, const T* q_i, const T* t_j, const T* q_j,
                  T* residuals) const {
    using Vector = Eigen::Map<const Eigen::Matrix<T, 3, 1>>;
    using Quaternion = Eigen::Map<const Eigen::Quaternion<T>>;
    Eigen::Map<Eigen::Matrix<T, 6, 1>>(residuals).noalias() =
        root.cast<T>() *
        Of<T>(Vector(t_i), Quaternion(q_i), Vector(t_j), Quaternion(q_j));
    return true;
  }

  G2oPose measured;
  MotionMatrix root;  // root^T root = information
};

struct G2oEdge {
  int i = 0, j = 0;
  G2oError error;
};

struct G2oGraph {
  std::map<int, G2oPose> poses;
  std::vector<int> fixed;
  std::vector<G2oEdge> edges;
};

std::istream& operator>>(std::istream& in, G2oPose& pose) {
  for (double& value : pose.t) in >> value;
  for (double& value : pose.q.coeffs()) in >> value;
  EXPECT_NEAR(pose.q.norm(), 1.0, 1e-8);
  return in;
}

G2oGraph ReadG2o(const std::string& text) {
  G2oGraph graph;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    std::string tag;
    in >> tag;
    if (tag == "VERTEX_SE3:QUAT") {
      int id = 0;
      in >> id;
      EXPECT_EQ(graph.poses.count(id), 0U);
      in >> graph.poses[id];
    } else if (tag == "FIX") {
      in >> graph.fixed.emplace_back();
    } else {
      EXPECT_EQ(tag, "EDGE_SE3:QUAT");
      G2oEdge edge;
      in >> edge.i >> edge.j >> edge.error.measured;
      MotionMatrix information;
      for (int row = 0; row < 6; ++row) {
        for (int col = row; col < 6; ++col) {
          in >> information(row, col);
          information(col, row) = information(row, col);
        }
      }
      const Eigen::LLT<MotionMatrix> llt(information);
      EXPECT_EQ(llt.info(), Eigen::Success);
      edge.error.root = llt.matrixU();
      graph.edges.push_back({edge});
    }
    EXPECT_TRUE(in) << line;
    EXPECT_TRUE((in >> std::ws).eof()) << line;
  }
  return graph;
}

// Minimises the cost over the poses; returns the costs before and after.
std::pair<double, double> Optimise(G2oGraph* graph) {
  ceres::Problem problem;
  for (auto& [id, pose] : graph->poses) {
    problem.AddParameterBlock(pose.t.data(), 3);
    problem.AddParameterBlock(pose.q.coeffs().data(), 4,
                              new ceres::EigenQuaternionManifold);
  }
  for (const G2oEdge& edge : graph->edges) {
    G2oPose& i = graph->poses.at(edge.i);
    G2oPose& j = graph->poses.at(edge.j);
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<G2oError, 6, 3, 4, 3, 4>(
            new G2oError(edge.error)),
        nullptr, i.t.data(), i.q.coeffs().data(), j.t.data(),
        j.q.coeffs().data());
  }
  for (const int id : graph->fixed) {
    problem.SetParameterBlockConstant(graph->poses.at(id).t.data());
    problem.SetParameterBlockConstant(graph->poses.at(id).q.coeffs().data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.function_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_TRUE(summary.IsSolutionUsable());
  return {summary.initial_cost, summary.final_cost};
}

// A covariance with correlations between all components, which all differ.
MotionMatrix AnyCovariance(RandomWorld* world) {
  MotionMatrix root = MotionMatrix::Identity();
  for (double& value : root.reshaped()) value += world->Uniform(-0.5, 0.5);
  MotionVector sigmas;  // rad and m
  sigmas << 0.002, 0.001, 0.004, 0.01, 0.003, 0.006;
  return sigmas.asDiagonal() * (root * root.transpose()) * sigmas.asDiagonal();
}

// A map in two segments: a tour with chords across it, and a short one.
KeyframeMap SolvedMap() {
  constexpr int kPoses = 40, kSecond = 35;  // first pose of the second segment
  RandomWorld world(4);
  const std::vector<Rigid3d> truth = CircleOfPoses(kPoses, 3.0);
  KeyframeMap map;
  PoseGraph graph;
  for (int i = 0; i < kPoses; ++i) {
    const bool is_first = i == 0 || i == kSecond;
    graph.AddPose(is_first ? truth[i] : truth[i] * world.Motion(0.02, 0.02),
                  is_first);
    map.keyframes.push_back({7 + 3 * i, i < kSecond ? 0 : 1, Rigid3d(), {}});
  }
  for (int cur = 1; cur < kPoses; ++cur) {
    for (const int step : {1, 2, 7, 17}) {
      const int ref = cur - step;
      if (ref < 0 || (ref < kSecond) != (cur < kSecond)) continue;
      RelativePose edge = MeasuredEdge(truth, ref, cur, 0.003, 0.005, &world);
      edge.covariance = AnyCovariance(&world);
      graph.AddEdge(edge);
      edge.ref = map.keyframes[ref].id;
      edge.cur = map.keyframes[cur].id;
      map.edges.push_back({edge});
    }
  }
  const GraphSolution solution = graph.Solve();
  EXPECT_TRUE(solution.ok()) << solution.reason;
  for (int i = 0; i < kPoses; ++i) {
    map.keyframes[i].world_from_cam = graph.pose(i);
  }
  return map;
}

// Solves the same problem as Ceres' example pose_graph_3d, which reads this
// format but is in no package.
TEST(G2oTest, OthersFindNothingToImprove) {
  const KeyframeMap map = SolvedMap();
  G2oGraph graph = ReadG2o(FormatG2o(map));
  ASSERT_EQ(graph.poses.size(), map.keyframes.size());
  ASSERT_EQ(graph.edges.size(), map.edges.size());
  EXPECT_EQ(graph.fixed, std::vector<int>({7, 7 + 3 * 35}));
  const auto [before, after] = Optimise(&graph);
  // Half the chi^2 of the remaining disagreement between these edges.
  EXPECT_GT(after, 50.0);
  EXPECT_LT(before, (1.0 + 1e-6) * after);
  for (const Keyframe& keyframe : map.keyframes) {
    const G2oPose& pose = graph.poses.at(keyframe.id);
    const MotionError moved =
        ErrorOf(Rigid3d(pose.q, pose.t), keyframe.world_from_cam);
    EXPECT_LT(moved.translation, 1e-6);
    EXPECT_LT(moved.angle, 1e-6);
  }
}

// The cost equals ours, not only to second order, for large errors as well.
TEST(G2oTest, CostOfAnEdgeIsOurs) {
  RandomWorld world(6);
  for (int trial = 0; trial < 50; ++trial) {
    KeyframeMap map;
    for (int id = 0; id < 2; ++id) {
      map.keyframes.push_back({id, 0, world.Motion(3.0, 2.0), {}});
    }
    const Rigid3d motion = map.keyframes[1].world_from_cam.Inverse() *
                           map.keyframes[0].world_from_cam;
    RelativePose edge;
    edge.cur = 1;
    edge.cur_from_ref = world.Motion(1.0, 0.5) * motion;
    edge.covariance = AnyCovariance(&world);
    map.edges.push_back({edge});
    G2oGraph graph = ReadG2o(FormatG2o(map));
    const G2oPose& i = graph.poses.at(0);
    const G2oPose& j = graph.poses.at(1);
    const MotionVector e = graph.edges[0].error.Of(i.t, i.q, j.t, j.q);

    MotionVector r;
    RelativePoseFactor{edge.cur_from_ref,
                       SqrtInformationOfCovariance(edge.covariance)}
        .Residual(PoseFrom(map.keyframes[0].world_from_cam),
                  PoseFrom(map.keyframes[1].world_from_cam), r.data());
    const double cost = (graph.edges[0].error.root * e).squaredNorm();
    EXPECT_NEAR(cost, r.squaredNorm(), 1e-6 * r.squaredNorm());
  }
}

TEST(SlamWarningTest, SaysHowOftenPosesWereNotSolvedForAndWhy) {
  const Slam slam({}, {}, {});
  std::vector<SlamFrame> frames(3);
  EXPECT_EQ(SlamWarning(SlamToJson(slam, frames)), "");
  frames[0].error = "a";
  frames[1].error = "pose 3 is not finite";
  EXPECT_EQ(SlamWarning(SlamToJson(slam, frames)),
            "solving for the map's poses failed 2 times; last reason: pose 3 "
            "is not finite");
}

// Matrices in docs/runs.md that convert our errors to other conventions. The
// true motion is off the measured one by [w C], R_true = Exp(w) R.
TEST(EdgeConventionsTest, MatricesOfThePageAreTheDerivatives) {
  RandomWorld world(8);
  const Rigid3d measured = world.Motion(1.0, 1.0);  // cur_from_ref
  const Eigen::Matrix3d R = measured.rotation.toRotationMatrix();
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
  MotionMatrix ros, gtsam, g2o;
  ros << none, I, -I, none;
  gtsam << -I, none, none, R;
  g2o << none, R, -0.5 * I, none;

  const auto log = [](const Eigen::Quaterniond& q) {
    const Eigen::AngleAxisd turn(q);
    return Eigen::Vector3d(turn.angle() * turn.axis());
  };
  constexpr double kStep = 1e-6;
  MotionMatrix found_ros, found_gtsam, found_g2o;
  for (int k = 0; k < 6; ++k) {
    MotionVector plus[3], minus[3];
    for (const double step : {kStep, -kStep}) {
      const MotionVector e = step * MotionVector::Unit(k);
      const Eigen::Vector3d w = e.head<3>();
      const Eigen::Quaterniond turn =
          Eigen::AngleAxisd(w.norm(), w.normalized()) * measured.rotation;
      const Eigen::Vector3d C = measured.Inverse().translation + e.tail<3>();
      // The measured and the true edge of a pose graph: ref_from_cur.
      const Rigid3d Z = measured.Inverse();
      const Rigid3d X(turn.conjugate(), C);
      const Rigid3d E = Z.Inverse() * X;
      MotionVector* const out = step > 0.0 ? plus : minus;
      // ROS: position in reference axes, rotation about current axes.
      out[0] << X.translation - Z.translation, log(E.rotation);
      out[1] << log(E.rotation), E.translation;   // GTSAM's Logmap to
      out[2] << E.translation, E.rotation.vec();  // first order; g2o
    }
    found_ros.col(k) = (plus[0] - minus[0]) / (2.0 * kStep);
    found_gtsam.col(k) = (plus[1] - minus[1]) / (2.0 * kStep);
    found_g2o.col(k) = (plus[2] - minus[2]) / (2.0 * kStep);
  }
  EXPECT_LT((found_ros - ros).norm(), 1e-8);
  EXPECT_LT((found_gtsam - gtsam).norm(), 1e-8);
  EXPECT_LT((found_g2o - g2o).norm(), 1e-8);
}

}  // namespace
}  // namespace rgbd_pose
