#include "core/evaluation/fixing_parameters.h"

#include <Eigen/Eigenvalues>

#include "core/geometry/twist.h"
#include "core/util/format.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

constexpr double kShiftUnit = 0.02;                        // s
constexpr double kRotationUnit = 2.0 * kRadiansPerDegree;  // rad
constexpr double kLeverUnit = 0.05;                        // m

// A direction is of time, rotation or lever if so much of its square is. One
// of all three has a third in one of them at least.
constexpr double kNamedShare = 0.3;

// Axes that the directions have in three of the parameters.
void NameAxes(const Eigen::Matrix<double, 3, Eigen::Dynamic>& part,
              const std::string& name, const char* relation,
              std::vector<std::string>* names) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(part *
                                                            part.transpose());
  if (axes.eigenvalues()[0] > kNamedShare) {
    names->push_back(name);
    return;
  }
  for (int i = 2; i > 0 && axes.eigenvalues()[i] > kNamedShare; --i) {
    Eigen::Vector3d axis = axes.eigenvectors().col(i);
    int largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis[largest] < 0.0) axis = -axis;
    names->push_back(name + Format(" %s (%.2f, %.2f, %.2f)", relation, axis.x(),
                                   axis.y(), axis.z()));
  }
}

}  // namespace

FixingVector FixingUnits() {
  FixingVector units;
  units << kShiftUnit, Eigen::Vector3d::Constant(kRotationUnit),
      Eigen::Vector3d::Constant(kLeverUnit);
  return units;
}

TruthFixing FixingAt(const FixingVector& x) {
  const FixingVector value = x.cwiseProduct(FixingUnits());
  const Twist turn{value.segment<3>(1), Eigen::Vector3d::Zero()};
  return {value[0], Rigid3d(turn.MotionDuring(-1.0).rotation, value.tail<3>())};
}

std::vector<std::string> NameFixingDirections(
    const Eigen::Matrix<double, 7, Eigen::Dynamic>& directions) {
  std::vector<std::string> names;
  if (directions.row(0).squaredNorm() > kNamedShare) {
    names.emplace_back("time shift");
  }
  NameAxes(directions.middleRows<3>(1), "rotation", "about", &names);
  NameAxes(directions.bottomRows<3>(), "lever", "along", &names);
  return names;
}

}  // namespace rgbd_pose
