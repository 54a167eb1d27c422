#include <Eigen/Cholesky>
#include <algorithm>
#include <type_traits>
#include <vector>

#include "core/factors/blocks.h"
#include "costs/calibration/bundle_adjustment.h"
#include "costs/calibration/landmark_factors.h"
#include "costs/calibration/scaled_distance.h"

namespace rgbd_pose {
namespace {

// As in core/estimation/covariance_accumulator.cc.
constexpr double kMinSlope = 0.2;

// The normal equations of one landmark at a time.
class OneLandmark {
 public:
  explicit OneLandmark(ReducedCameraSystem* equations)
      : equations_(*equations) {}

  void Begin(const Landmark& landmark) {
    anchor_ = landmark.anchor;
    const int rows = kFixed + 6 * landmark.num_views;
    local_.setZero(rows, rows);
    by_depth_.setZero(rows);
    gradient_.setZero(rows);
    hessian_d_ = gradient_d_ = 0.0;
    keyframes_.clear();
  }

  void BeginView(int keyframe) { keyframes_.push_back(keyframe); }
  int num_views() const { return static_cast<int>(keyframes_.size()); }

  // Adds a residual of the view begun last.
  template <int kRows>
  void Add(const Eigen::Matrix<double, kRows, 1>& r,
           const TangentJacobian<kRows, PoseBlock>& by_anchor,
           const TangentJacobian<kRows, PoseBlock>& by_view,
           const TangentJacobian<kRows, InverseDepthBlock>& by_depth,
           const TangentJacobian<kRows, CalibrationBlock>& by_y) {
    const double weight = WeightOf(r);
    Eigen::Matrix<double, kRows, kFixed> head;
    head << by_anchor, by_y;
    local_.topLeftCorner<kFixed, kFixed>().noalias() +=
        weight * head.transpose() * head;
    by_depth_.head<kFixed>() += weight * head.transpose() * by_depth;
    gradient_.head<kFixed>() += weight * head.transpose() * r;
    hessian_d_ += weight * by_depth.squaredNorm();
    gradient_d_ += weight * by_depth.dot(r);
    const int place = kFixed + 6 * (num_views() - 1);
    local_.block<6, kFixed>(place, 0).noalias() +=
        weight * by_view.transpose() * head;
    local_.block<6, 6>(place, place).noalias() +=
        weight * by_view.transpose() * by_view;
    by_depth_.segment<6>(place) += weight * by_view.transpose() * by_depth;
    gradient_.segment<6>(place) += weight * by_view.transpose() * r;
  }

  // Eliminates the depth, which is optimal for any values of the other
  // unknowns, and adds the remaining equations.
  void MoveToEquations() {
    if (!(hessian_d_ > 0.0)) return;
    const int length = kFixed + 6 * num_views();
    for (int k = 0; k < length; ++k) {
      const int below = length - k;
      local_.col(k).segment(k, below) -=
          by_depth_[k] / hessian_d_ * by_depth_.segment(k, below);
    }
    gradient_.head(length) -=
        by_depth_.head(length) * (gradient_d_ / hessian_d_);
    Eigen::MatrixXd& H = equations_.hessian;
    for (int i = 0; i < num_views() + 2; ++i) {
      const Block a = BlockAt(i);
      if (a.to < 0) continue;
      equations_.gradients.col(anchor_).segment(a.to, a.size) +=
          gradient_.segment(a.from, a.size);
      for (int j = 0; j <= i; ++j) {
        const Block b = BlockAt(j);
        if (b.to < 0) continue;
        const auto block = local_.block(a.from, b.from, a.size, b.size);
        if (a.to >= b.to) {
          H.block(a.to, b.to, a.size, b.size) += block;
        } else {
          H.block(b.to, a.to, b.size, a.size) += block.transpose();
        }
      }
    }
  }

 private:
  static constexpr int kFixed = 6 + kCalibrationSize;  // anchor and y

  // The unknowns of the anchor, y or a view: their place and number here, and
  // their place among all unknowns.
  struct Block {
    int from;
    int size;
    int to;
  };
  Block BlockAt(int i) const {
    if (i == 0) return {0, 6, equations_.PlaceOfPose(anchor_)};
    if (i == 1) return {6, kCalibrationSize, equations_.PlaceOfY()};
    return {kFixed + 6 * (i - 2), 6, equations_.PlaceOfPose(keyframes_[i - 2])};
  }

  // rho' of Cauchy's loss.
  template <typename Residual>
  double WeightOf(const Residual& r) {
    constexpr double kWidth2 = kLandmarkLossWidth * kLandmarkLossWidth;
    const double s = r.squaredNorm();
    const double weight = 1.0 / (1.0 + s / kWidth2);
    const double curvature = -weight * weight / kWidth2;
    equations_.weight_p += weight * r.size();
    equations_.slope_p += weight * r.size() + 2.0 * s * curvature;
    return weight;
  }

  ReducedCameraSystem& equations_;
  int anchor_ = 0;
  std::vector<int> keyframes_;  // of the views
  Eigen::MatrixXd local_;       // [anchor, y, views], the lower triangle
  Eigen::VectorXd by_depth_;    // against the landmark's depth
  Eigen::VectorXd gradient_;
  double hessian_d_ = 0.0, gradient_d_ = 0.0;  // of the depth
};

// A known distance among the unknowns of a ReducedCameraSystem.
struct DistanceEquation {
  int place_a, place_b;  // of the poses; negative: the first, a constant
  TangentJacobian<1, PoseBlock> by_a, by_b;
  TangentJacobian<1, CalibrationBlock> by_y;
};

std::vector<DistanceEquation> DistanceEquations(const CalibrationViews& views,
                                                const CalibrationOrigin& origin,
                                                const CalibrationState& state) {
  const auto model = ModelOf(views, origin);
  const CalibrationVector y = origin.NumbersOf(state.theta);
  std::vector<DistanceEquation> equations;
  for (const KnownDistance& known : views.distances) {
    DistanceEquation equation;
    equation.place_a = ReducedCameraSystem::PlaceOfPose(known.a);
    equation.place_b = ReducedCameraSystem::PlaceOfPose(known.b);
    double r;
    ScaledDistanceFactor{model, known}.Jacobian(
        PoseFrom(state.world_from_cam[known.a]),
        PoseFrom(state.world_from_cam[known.b]), y, &r, &equation.by_a,
        &equation.by_b, &equation.by_y);
    equations.push_back(equation);
  }
  return equations;
}

// The information of known distances and the prior.
Eigen::MatrixXd KnownBefore(const ReducedCameraSystem& equations,
                            const std::vector<DistanceEquation>& distances) {
  const Eigen::Index size = equations.hessian.rows();
  const int y_at = equations.PlaceOfY();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  for (const auto& [place_a, place_b, by_a, by_b, by_y] : distances) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
    if (place_a >= 0) row.segment<6>(place_a) += by_a.transpose();
    if (place_b >= 0) row.segment<6>(place_b) += by_b.transpose();
    row.segment<kCalibrationSize>(y_at) += by_y.transpose();
    information.noalias() += row * row.transpose();
  }
  information.diagonal().tail<kCalibrationSize>().array() += 1.0;
  // For keyframes that no landmark connects with the first one: little, but
  // more than rounding errors.
  information.diagonal().head(y_at).array() +=
      1e-9 + 1e-12 * equations.hessian.diagonal().maxCoeff();
  return information;
}

// The covariance of y due to the scatter of landmarks. `inverse`: the columns
// of y in the inverse of all equations.
Eigen::MatrixXd LandmarkScatter(const ReducedCameraSystem& equations,
                                const Eigen::MatrixXd& inverse) {
  // The shift of y due to the landmarks of each anchor keyframe.
  const Eigen::MatrixXd moves = inverse.transpose() * equations.gradients;
  int groups = 0;
  for (Eigen::Index k = 0; k < moves.cols(); ++k) {
    groups += moves.col(k).norm() > 0.0;
  }
  const double correction =
      groups > 1 ? static_cast<double>(groups) / (groups - 1) : 1.0;
  return correction * moves * moves.transpose();
}

// The same due to distances and the prior, whose noise is taken as stated.
CalibrationMatrix StatedScatter(const std::vector<DistanceEquation>& distances,
                                const Eigen::MatrixXd& inverse) {
  const auto of_y = inverse.bottomRows<kCalibrationSize>();
  CalibrationMatrix scatter = of_y.transpose() * of_y;
  for (const auto& [place_a, place_b, by_a, by_b, by_y] : distances) {
    CalibrationVector move = of_y.transpose() * by_y.transpose();
    if (place_a >= 0) {
      move += inverse.middleRows<6>(place_a).transpose() * by_a.transpose();
    }
    if (place_b >= 0) {
      move += inverse.middleRows<6>(place_b).transpose() * by_b.transpose();
    }
    scatter += move * move.transpose();
  }
  return scatter;
}

}  // namespace

ReducedCameraSystem MakeReducedCameraSystem(const CalibrationViews& views,
                                            bool training_only,
                                            const CalibrationOrigin& origin,
                                            const CalibrationState& state) {
  const auto model = ModelOf(views, origin);
  const std::vector<PoseOf<double>> poses = PosesOf(state);
  const CalibrationVector y = origin.NumbersOf(state.theta);
  const int num_poses = static_cast<int>(poses.size());
  const int size = 6 * (num_poses - 1) + kCalibrationSize;
  ReducedCameraSystem equations;
  equations.hessian = Eigen::MatrixXd::Zero(size, size);
  equations.gradients = Eigen::MatrixXd::Zero(size, num_poses);
  OneLandmark one(&equations);
  // Adds the residual of a view.
  const auto add = [&](const auto& factor, const Landmark& landmark,
                       int keyframe, const Eigen::Matrix<double, 1, 1>& d) {
    constexpr int kRows = std::decay_t<decltype(factor)>::kRows;
    Eigen::Matrix<double, kRows, 1> r;
    TangentJacobian<kRows, PoseBlock> by_anchor, by_view;
    TangentJacobian<kRows, InverseDepthBlock> by_depth;
    TangentJacobian<kRows, CalibrationBlock> by_y;
    factor.Jacobian(poses[landmark.anchor], poses[keyframe], d, y, r.data(),
                    &by_anchor, &by_view, &by_depth, &by_y);
    one.Add<kRows>(r, by_anchor, by_view, by_depth, by_y);
  };
  for (size_t i = 0; i < views.landmarks.size(); ++i) {
    const Landmark& landmark = views.landmarks[i];
    const Eigen::Matrix<double, 1, 1> d(state.inverse_depths[i]);
    one.Begin(landmark);
    for (int k = 0; k < landmark.num_views; ++k) {
      const LandmarkView& view = views.views[landmark.first_view + k];
      if (!view.TakesPart(training_only)) continue;
      const LandmarkData data = DataOf(views, landmark, view, state);
      one.BeginView(view.keyframe);
      add(LandmarkPixelFactor{model, data}, landmark, view.keyframe, d);
      if (data.depth.inverse_sigma > 0.0) {
        add(LandmarkDepthFactor{model, data}, landmark, view.keyframe, d);
      }
    }
    if (one.num_views() == 0) continue;
    const auto no_pose = TangentJacobian<1, PoseBlock>::Zero().eval();
    Eigen::Matrix<double, 1, 1> r, by_depth;
    TangentJacobian<1, CalibrationBlock> by_y;
    AnchorDepthFactor{model, DataOf(views, landmark, state)}.Jacobian(
        d, y, r.data(), &by_depth, &by_y);
    // It depends on no pose, whichever view it is added to.
    one.Add<1>(r, no_pose, no_pose, by_depth, by_y);
    one.MoveToEquations();
  }
  return equations;
}

bool LandmarkCovariance(const CalibrationViews& views, bool training_only,
                        const CalibrationOrigin& origin,
                        const CalibrationState& state,
                        CalibrationMatrix* model_covariance,
                        CalibrationMatrix* sandwich_covariance) {
  const ReducedCameraSystem equations =
      MakeReducedCameraSystem(views, training_only, origin, state);
  const std::vector<DistanceEquation> distances =
      DistanceEquations(views, origin, state);
  const Eigen::MatrixXd known_before = KnownBefore(equations, distances);
  Eigen::MatrixXd last;  // columns of the inverse
  const auto invert = [&](double slope) {
    Eigen::MatrixXd H = slope * equations.hessian + known_before;
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Lower> cholesky(H);
    last = Eigen::MatrixXd::Zero(H.rows(), kCalibrationSize);
    last.bottomRows<kCalibrationSize>().setIdentity();
    cholesky.solveInPlace(last);
    return cholesky.info() == Eigen::Success;
  };
  const auto scale = origin.width.asDiagonal();
  if (!invert(1.0)) return false;
  *model_covariance = scale * last.bottomRows<kCalibrationSize>() * scale;
  const double slope =
      equations.weight_p > 0.0 ? equations.slope_p / equations.weight_p : 1.0;
  if (!invert(std::max(slope, kMinSlope))) return false;
  *sandwich_covariance =
      scale *
      (LandmarkScatter(equations, last) + StatedScatter(distances, last)) *
      scale;
  return model_covariance->allFinite() && sandwich_covariance->allFinite();
}

}  // namespace rgbd_pose
