#include <Eigen/Cholesky>
#include <algorithm>

#include "costs/calibration/bundle_adjustment.h"
#include "costs/calibration/landmark_block.h"

namespace rgbd_pose {
namespace {

// As in core/estimation/covariance_accumulator.cc.
constexpr double kMinSlope = 0.2;

// The normal equations of one landmark at a time.
class OneLandmark {
 public:
  OneLandmark(const CalibrationOrigin& origin, ReducedCameraSystem* equations)
      : origin_(origin), equations_(*equations) {}

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
  template <typename Derivatives, typename Residual>
  void Add(const Derivatives& J, const Residual& r) {
    const double weight = WeightOf(r);
    Eigen::Matrix<double, Residual::RowsAtCompileTime, kFixed> head;
    head << J.anchor, J.theta * origin_.width.asDiagonal();
    local_.topLeftCorner<kFixed, kFixed>().noalias() +=
        weight * head.transpose() * head;
    by_depth_.head<kFixed>() += weight * head.transpose() * J.inverse_depth;
    gradient_.head<kFixed>() += weight * head.transpose() * r;
    hessian_d_ += weight * J.inverse_depth.squaredNorm();
    gradient_d_ += weight * J.inverse_depth.dot(r);
    const int place = kFixed + 6 * (num_views() - 1);
    local_.block<6, kFixed>(place, 0).noalias() +=
        weight * J.view.transpose() * head;
    local_.block<6, 6>(place, place).noalias() +=
        weight * J.view.transpose() * J.view;
    by_depth_.segment<6>(place) +=
        weight * J.view.transpose() * J.inverse_depth;
    gradient_.segment<6>(place) += weight * J.view.transpose() * r;
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

  const CalibrationOrigin& origin_;
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
  KnownDistanceError error;
  double factor_width;  // of the depth factor in CalibrationOrigin
};

std::vector<DistanceEquation> DistanceEquations(const CalibrationViews& views,
                                                const CalibrationOrigin& origin,
                                                const CalibrationState& state) {
  const std::vector<MotionDerivatives> poses = PosesOf(state);
  std::vector<DistanceEquation> equations;
  for (const KnownDistance& known : views.distances) {
    equations.push_back({ReducedCameraSystem::PlaceOfPose(known.a),
                         ReducedCameraSystem::PlaceOfPose(known.b),
                         KnownDistanceError(poses[known.a], poses[known.b],
                                            state.theta[kDepthFactor], known),
                         origin.width[kDepthFactor]});
  }
  return equations;
}

// The information of known distances and the prior.
Eigen::MatrixXd KnownBefore(const ReducedCameraSystem& equations,
                            const std::vector<DistanceEquation>& distances) {
  const Eigen::Index size = equations.hessian.rows();
  const int y_at = equations.PlaceOfY();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  for (const auto& [place_a, place_b, error, factor_width] : distances) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(size);
    if (place_a >= 0) row.segment<6>(place_a) += error.a.transpose();
    if (place_b >= 0) row.segment<6>(place_b) += error.b.transpose();
    row[y_at + kDepthFactor] += error.by_factor * factor_width;
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
  for (const auto& [place_a, place_b, error, factor_width] : distances) {
    CalibrationVector move =
        of_y.row(kDepthFactor).transpose() * error.by_factor * factor_width;
    if (place_a >= 0) {
      move += inverse.middleRows<6>(place_a).transpose() * error.a.transpose();
    }
    if (place_b >= 0) {
      move += inverse.middleRows<6>(place_b).transpose() * error.b.transpose();
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
  const std::vector<MotionDerivatives> poses = PosesOf(state);
  const int num_poses = static_cast<int>(poses.size());
  const int size = 6 * (num_poses - 1) + kCalibrationSize;
  ReducedCameraSystem equations;
  equations.hessian = Eigen::MatrixXd::Zero(size, size);
  equations.gradients = Eigen::MatrixXd::Zero(size, num_poses);
  OneLandmark one(origin, &equations);
  Eigen::Matrix<double, 1, 1> r1;
  Eigen::Vector2d r2;
  LandmarkDerivatives<1> J1;
  LandmarkDerivatives<2> J2;
  for (size_t i = 0; i < views.landmarks.size(); ++i) {
    const Landmark& landmark = views.landmarks[i];
    const double d = state.inverse_depths[i];
    const MotionDerivatives& anchor = poses[landmark.anchor];
    one.Begin(landmark);
    for (int k = 0; k < landmark.num_views; ++k) {
      const LandmarkView& view = views.views[landmark.first_view + k];
      if (!view.TakesPart(training_only)) continue;
      const LandmarkData data = DataOf(views, landmark, view, state);
      const MotionDerivatives& there = poses[view.keyframe];
      one.BeginView(view.keyframe);
      LandmarkPixel::Jacobian(anchor, there, d, state.theta.data(), data,
                              r2.data(), &J2);
      one.Add(J2, r2);
      if (data.depth.inverse_sigma > 0.0) {
        LandmarkDepth::Jacobian(anchor, there, d, state.theta.data(), data,
                                r1.data(), &J1);
        one.Add(J1, r1);
      }
    }
    if (one.num_views() == 0) continue;
    AnchorDepth::Jacobian(anchor, anchor, d, state.theta.data(),
                          DataOf(views, landmark, state), r1.data(), &J1);
    one.Add(J1, r1);  // depends on no pose, whichever view it is added to
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
