#pragma once

#include "core/geometry/motion.h"
#include "core/util/lane_math.h"

// A point of one frame in the axes of the other frame, and its derivatives. All
// costs on points are functions of these.

namespace rgbd_pose {

// q = R (X_prev - C): a point of the previous frame in current axes.
struct Forward {
  template <typename M, typename D, typename T>
  static void TransformPoint(const RotationAndCenter<M>& motion, const D* point,
                             T* q) {
    const T d[3] = {point[0] - motion.C[0], point[1] - motion.C[1],
                    point[2] - motion.C[2]};
    Multiply(motion.R, d, q);
  }

  // dq / d x[parameter]: (dR / d angle) (X_prev - C) and -R.
  template <typename D>
  static void Derivative(const MotionDerivatives& motion, const D* point,
                         int parameter, D* dq) {
    if (parameter < 3) {
      const D d[3] = {point[0] - motion.C[0], point[1] - motion.C[1],
                      point[2] - motion.C[2]};
      Multiply(motion.dR[parameter], d, dq);
    } else {
      for (int i = 0; i < 3; ++i) dq[i] = D{} - motion.R(i, parameter - 3);
    }
  }
};

// One row of a Jacobian. `gradient`: of the residual, by the moved point q.
template <typename D>
[[gnu::always_inline]] inline void RowOfPoint(const MotionDerivatives& motion,
                                              const D* point,
                                              const D (&gradient)[3], D* row) {
  for (int parameter = 0; parameter < 6; ++parameter) {
    D dq[3];
    Forward::Derivative(motion, point, parameter, dq);
    row[parameter] =
        gradient[0] * dq[0] + gradient[1] * dq[1] + gradient[2] * dq[2];
  }
}

// p = R^T X_cur + C: a point of the current frame in previous axes.
struct Backward {
  template <typename M, typename D, typename T>
  static void TransformPoint(const RotationAndCenter<M>& motion, const D* point,
                             T* p) {
    MultiplyTransposed(motion.R, point, p);
    for (int i = 0; i < 3; ++i) p[i] += motion.C[i];
  }

  // dp / d x[parameter]: (dR / d angle)^T X_cur and I.
  template <typename D>
  static void Derivative(const MotionDerivatives& motion, const D* point,
                         int parameter, D* dp) {
    if (parameter < 3) {
      MultiplyTransposed(motion.dR[parameter], point, dp);
    } else {
      for (int i = 0; i < 3; ++i)
        dp[i] = D{} + (i == parameter - 3 ? 1.0 : 0.0);
    }
  }
};

}  // namespace rgbd_pose
