#include "benchmarks/bundle_adjustment.h"

#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include <memory>

#include "core/geometry/motion.h"

namespace rgbd_pose {
namespace {

// One observation: r = [(u - u_m) / s_u, (v - v_m) / s_u, (1/z - 1/z_m) / s_d]
// of X_cam = R (X - C), the pose in the parameters of core/geometry/motion.h.
class SightingBlock final : public ceres::SizedCostFunction<3, 6, 3> {
 public:
  SightingBlock(const Camera& camera, const Observation& seen,
                const LinearizationPoint* origin)
      : camera_(camera), seen_(seen), origin_(origin) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const MotionDerivatives& pose = origin_->CachedDerivativesAt(parameters[0]);
    const Eigen::Vector3d d =
        Eigen::Map<const Eigen::Vector3d>(parameters[1]) - pose.C;
    const Eigen::Vector3d p = pose.R * d;
    if (p.z() < 1e-3) return false;
    const double z = 1.0 / p.z(), w = 1.0 / seen_.sigma_px;
    const double w_d = seen_.depth * seen_.depth / seen_.sigma_depth;
    residuals[0] = w * (camera_.fx * p.x() * z + camera_.cx - seen_.u);
    residuals[1] = w * (camera_.fy * p.y() * z + camera_.cy - seen_.v);
    residuals[2] = w_d * (z - 1.0 / seen_.depth);
    if (jacobians == nullptr) return true;
    Eigen::Matrix3d by_p;  // d r / d X_cam
    by_p << w * camera_.fx * z, 0.0, -w * camera_.fx * p.x() * z * z,  //
        0.0, w * camera_.fy * z, -w * camera_.fy * p.y() * z * z,      //
        0.0, 0.0, -w_d * z * z;
    const Eigen::Matrix3d by_point = by_p * pose.R;
    if (jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, 6, Eigen::RowMajor>> J{jacobians[0]};
      for (int k = 0; k < 3; ++k) J.col(k) = by_p * (pose.dR[k] * d);
      J.rightCols<3>() = -by_point;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{jacobians[1]} =
          by_point;
    }
    return true;
  }

 private:
  const Camera& camera_;
  const Observation& seen_;
  const LinearizationPoint* const origin_;
};

}  // namespace

BundleSolution AdjustBundle(const SimulatedGraph& graph,
                            const std::vector<Rigid3d>& start,
                            ceres::LossFunction* loss) {
  std::vector<int> views(graph.landmarks, 0);
  for (const auto& seen : graph.sightings) {
    for (const auto& sighting : seen) ++views[sighting.landmark];
  }
  std::vector<LinearizationPoint> origins;
  std::vector<MotionVector> x(start.size(), MotionVector::Zero());
  std::vector<Eigen::Vector3d> points(graph.landmarks);
  std::vector<bool> is_placed(graph.landmarks, false);
  origins.reserve(start.size());
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  auto order = std::make_shared<ceres::ParameterBlockOrdering>();
  for (size_t i = 0; i < start.size(); ++i) {
    origins.emplace_back(start[i].Inverse());
    for (const auto& [landmark, seen] : graph.sightings[i]) {
      if (views[landmark] < 2) continue;
      Eigen::Vector3d& point = points[landmark];
      if (!is_placed[landmark]) {
        point = start[i] * (graph.camera.Ray(seen.u, seen.v) * seen.depth);
        is_placed[landmark] = true;
        order->AddElementToGroup(point.data(), 0);
      }
      problem.AddResidualBlock(
          new SightingBlock(graph.camera, seen, &origins[i]), loss, x[i].data(),
          point.data());
    }
    order->AddElementToGroup(x[i].data(), 1);
  }
  problem.SetParameterBlockConstant(x[0].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.linear_solver_ordering = order;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  BundleSolution solution;
  for (size_t i = 0; i < start.size(); ++i) {
    solution.poses.push_back(origins[i].CurFromPrev(x[i].data()).Inverse());
  }
  solution.iterations = static_cast<int>(summary.iterations.size()) - 1;
  solution.residuals = problem.NumResiduals();
  return solution;
}

}  // namespace rgbd_pose
