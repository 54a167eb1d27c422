#include "costs/mounted_costs.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/geometry/motion.h"
#include "core/util/input_error.h"
#include "costs/assembly/cost_blocks.h"
#include "costs/parts/euler_rates.h"

namespace rgbd_pose {
namespace {

// A cost of the motion of a camera as one of the motion of its body.
class MountedCost final : public MotionCost {
 public:
  MountedCost(std::unique_ptr<MotionCost> cost, const CameraMounting& mounting)
      : cost_(std::move(cost)), mounting_(mounting) {}

  std::string_view name() const override { return cost_->name(); }
  int num_residuals() const override { return cost_->num_residuals(); }
  int degrees_of_freedom() const override {
    return cost_->degrees_of_freedom();
  }
  bool is_whitened() const override { return cost_->is_whitened(); }
  double InlierLimit(int k) const override { return cost_->InlierLimit(k); }
  int scale_group() const override { return cost_->scale_group(); }
  double information_factor() const override {
    return cost_->information_factor();
  }
  CameraMounting mounting() const override { return mounting_; }
  AssociationPolicy association() const override {
    return cost_->association();
  }
  int num_levels() const override { return cost_->num_levels(); }
  void SetLevel(int level) override { cost_->SetLevel(level); }
  void Bind(const FramePair& pair) override { cost_->Bind(pair); }
  void Associate(const Rigid3d& cur_from_prev) override {
    cost_->Associate(OfCamera(cur_from_prev));
  }
  void Reassociate(const Rigid3d& cur_from_prev) override {
    cost_->Reassociate(OfCamera(cur_from_prev));
  }
  const std::vector<int>& matches() const override { return cost_->matches(); }
  const std::vector<int>& degrees() const override { return cost_->degrees(); }

  void Residuals(const MotionDerivatives& motion,
                 std::vector<double>* residuals) const override {
    cost_->Residuals(OfCamera(motion), residuals);
  }

  void SquaredNorms(const MotionDerivatives& motion,
                    std::vector<double>* squared_norms) const override {
    cost_->SquaredNorms(OfCamera(motion), squared_norms);
  }

  void Linearise(const MotionDerivatives& motion,
                 const ceres::LossFunction* loss,
                 NormalEquations* sum) const override {
    NormalEquations of_camera;
    cost_->Linearise(OfCamera(motion), loss, &of_camera);
    const MotionMatrix by_body = Jacobian(motion);
    sum->hessian += by_body.transpose() * of_camera.hessian * by_body;
    sum->gradient += by_body.transpose() * of_camera.gradient;
    sum->cost += of_camera.cost;
  }

  void AddScoreOuterProduct(const MotionDerivatives& motion,
                            const ceres::LossFunction* loss,
                            MotionMatrix* scatter) const override {
    MotionMatrix of_camera = MotionMatrix::Zero();
    cost_->AddScoreOuterProduct(OfCamera(motion), loss, &of_camera);
    const MotionMatrix by_body = Jacobian(motion);
    *scatter += by_body.transpose() * of_camera * by_body;
  }

  void AddSpuriousInformation(const MotionDerivatives& motion,
                              MotionMatrix* hessian) const override {
    MotionMatrix of_camera = MotionMatrix::Zero();
    cost_->AddSpuriousInformation(OfCamera(motion), &of_camera);
    const MotionMatrix by_body = Jacobian(motion);
    *hessian += by_body.transpose() * of_camera * by_body;
  }

  void AddTo(Assembly assembly, const LinearizationPoint& origin,
             ceres::LossFunction* loss, double* x,
             ceres::Problem* problem) override {
    if (matches().empty()) return;
    const MotionSums sums(this, &origin, loss);
    ceres::CostFunction* block = nullptr;
    if (BlockOwnership(assembly) == ceres::TAKE_OWNERSHIP) {
      block = new MotionBlock(sums);
    } else {
      block = &block_.emplace(sums);
    }
    problem->AddResidualBlock(block, nullptr, x);
  }

 private:
  static Rigid3d RigidOf(const MotionDerivatives& motion) {
    return Rigid3d(Eigen::Quaterniond(motion.R), -(motion.R * motion.C));
  }

  Rigid3d OfCamera(const Rigid3d& motion) const {
    return CameraMotion(mounting_.body_from_cam, motion);
  }

  // With derivatives by [omega C] of the camera.
  MotionDerivatives OfCamera(const MotionDerivatives& motion) const {
    return DerivativesAt(OfCamera(RigidOf(motion)));
  }

  // d[omega C] of the camera / d(parameters of the body's motion).
  MotionMatrix Jacobian(const MotionDerivatives& motion) const {
    MotionMatrix jacobian =
        CameraMotionJacobian(mounting_.body_from_cam, RigidOf(motion));
    jacobian.leftCols<3>() *= EulerRateJacobian(motion);
    return jacobian;
  }

  const std::unique_ptr<MotionCost> cost_;
  const CameraMounting mounting_;
  std::optional<MotionBlock> block_;
};

}  // namespace

std::vector<RobustCost> MountCosts(std::vector<RobustCost> costs,
                                   const CameraMounting& mounting) {
  if (mounting.camera < 0) {
    throw InputError("the index of a camera must not be negative");
  }
  if (!mounting.body_from_cam.IsFinite()) {
    throw InputError("the mounting of camera " +
                     std::to_string(mounting.camera) + " is not finite");
  }
  for (RobustCost& cost : costs) {
    if (cost.cost == nullptr) throw InputError("a mounted cost is null");
    cost.cost = std::make_unique<MountedCost>(std::move(cost.cost), mounting);
  }
  return costs;
}

}  // namespace rgbd_pose
