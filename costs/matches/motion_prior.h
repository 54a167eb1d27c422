#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "core/estimation/motion_cost.h"
#include "core/util/lane_math.h"
#include "costs/parts/whitening.h"

namespace rgbd_pose {

// A prior factor on a predicted motion (in Kerl, Sturm & Cremers 2013 a motion
// model for dense odometry): one block of six rows,
//
//   r = L^T [ 1/2 vee(R R_p^T - R_p R^T) ; C - C_p ]
//
// with L L^T = MotionPrior::information. The upper half is the axis times the
// sine of the angle of the rotation Exp(omega) = R R_p^T, about the current
// axes. It shrinks again beyond 90 degrees, so the prediction has to be nearer.
// A prior without information is not used.
struct MotionPriorCost {
  static constexpr char kName[] = "motion_prior";
  static constexpr int kRows = 6;
  static constexpr int kDegreesOfFreedom = 6;
  static constexpr bool kIsWhitened = true;
  static constexpr bool kIsPrior = true;
  static constexpr int kPose = 9 + 3;  // R_p, column by column, and C_p
  static constexpr int kColumns = kPose + Whitening<6>::kColumns;

  static bool Pack(const CostInput& input, size_t /*i*/, double* columns) {
    const Rigid3d& motion = input.prior->mean;
    const Eigen::Matrix3d R = motion.rotation.toRotationMatrix();
    const Eigen::Vector3d C = motion.Inverse().translation;
    std::copy_n(R.data(), 9, columns);
    std::copy_n(C.data(), 3, columns + 9);
    return motion.IsFinite() &&
           PackInformation<6>(input.prior->information, columns + kPose);
  }

  template <typename M, typename D, typename T>
  static void Residual(const RotationAndCenter<M>& motion, const D* columns,
                       T* r) {
    T e[6];
    HalfTwist(columns, motion.R, e);
    for (int i = 0; i < 3; ++i) e[3 + i] = motion.C[i] - columns[9 + i];
    Whitening<6>::Whiten(columns + kPose, e, r);
  }

  template <typename D>
  static void Jacobian(const MotionDerivatives& motion, const D* columns, D* r,
                       D (*J)[6]) {
    Residual(motion, columns, r);
    for (int parameter = 0; parameter < 6; ++parameter) {
      D de[6] = {};
      if (parameter < 3) {
        HalfTwist(columns, motion.dR[parameter], de);
      } else {
        de[parameter] += 1.0;
      }
      Whitening<6>::WhitenColumn(columns + kPose, de, J, parameter);
    }
  }

 private:
  // 1/2 vee(A R_p^T - R_p A^T), which is half the sum of the cross products of
  // the columns of R_p and A.
  template <typename D, typename M, typename T>
  static void HalfTwist(const D* predicted, const Eigen::Matrix<M, 3, 3>& A,
                        T* twist) {
    T c[3][3];
    for (int k = 0; k < 3; ++k) Cross(predicted + 3 * k, A.col(k).data(), c[k]);
    for (int i = 0; i < 3; ++i) twist[i] = 0.5 * (c[0][i] + c[1][i] + c[2][i]);
  }
};

}  // namespace rgbd_pose
