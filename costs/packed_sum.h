#pragma once

#include <ceres/loss_function.h>

#include <cstring>
#include <vector>

#include "core/cost.h"
#include "core/motion.h"

// Sums over matches W at a time: the residual types' own templates run on GCC
// and Clang vector types. The instruction set is chosen at run time, so that a
// build for any x86-64 uses AVX2 or AVX-512 where the machine has it.

namespace rgbd_pose {

// The columns of all bound matches as a structure of arrays; padded by copies
// of the last match to a multiple of kMaxLanes.
struct PackedColumns {
  static constexpr int kMaxLanes = 8;
  std::vector<double> values;  // column k starts at k * stride
  int stride = 0;
  int size = 0;
};

namespace packed {

template <int W>
struct LanesOf {
  typedef double Type __attribute__((vector_size(W * sizeof(double))));
};

template <typename D>
inline void LoadColumns(const PackedColumns& columns, int num_columns, int i,
                        D* m) {
  for (int k = 0; k < num_columns; ++k) {
    std::memcpy(&m[k], &columns.values[k * columns.stride + i], sizeof(D));
  }
}

template <typename Residual, int W>
[[gnu::always_inline]] inline void SquaredNormsLoop(
    const MotionDerivatives& motion, const PackedColumns& columns,
    double* squared_norms) {
  using D = typename LanesOf<W>::Type;
  for (int i = 0; i < columns.size; i += W) {
    D m[Residual::kColumns];
    LoadColumns(columns, Residual::kColumns, i, m);
    D r[Residual::kRows];
    Residual::Residual(motion, m, r);
    D s = r[0] * r[0];
    for (int row = 1; row < Residual::kRows; ++row) s += r[row] * r[row];
    const int lanes = columns.size - i < W ? columns.size - i : W;
    std::memcpy(squared_norms + i, &s, lanes * sizeof(double));
  }
}

template <typename Residual, int W>
[[gnu::always_inline]] inline void LineariseLoop(
    const MotionDerivatives& motion, const PackedColumns& columns,
    const ceres::LossFunction* loss, NormalEquations* sum) {
  using D = typename LanesOf<W>::Type;
  D hessian[21] = {};  // upper triangle, row by row
  D gradient[6] = {};
  double cost = 0.0;
  for (int i = 0; i < columns.size; i += W) {
    D m[Residual::kColumns];
    LoadColumns(columns, Residual::kColumns, i, m);
    D r[Residual::kRows];
    D J[Residual::kRows][6];
    Residual::Jacobian(motion, m, r, J);
    D s = r[0] * r[0];
    for (int row = 1; row < Residual::kRows; ++row) s += r[row] * r[row];
    D weight = {};
    for (int lane = 0; lane < W && i + lane < columns.size; ++lane) {
      double rho[3] = {s[lane], 1.0, 0.0};
      if (loss != nullptr) loss->Evaluate(s[lane], rho);
      cost += rho[0];
      weight[lane] = rho[1];
    }
    int entry = 0;
    for (int a = 0; a < 6; ++a) {
      D wJ[Residual::kRows];
      for (int row = 0; row < Residual::kRows; ++row) {
        wJ[row] = weight * J[row][a];
      }
      D g = wJ[0] * r[0];
      for (int row = 1; row < Residual::kRows; ++row) g += wJ[row] * r[row];
      gradient[a] += g;
      for (int b = a; b < 6; ++b) {
        D h = wJ[0] * J[0][b];
        for (int row = 1; row < Residual::kRows; ++row)
          h += wJ[row] * J[row][b];
        hessian[entry++] += h;
      }
    }
  }
  sum->cost += 0.5 * cost;
  int entry = 0;
  for (int a = 0; a < 6; ++a) {
    for (int lane = 0; lane < W; ++lane) sum->gradient[a] += gradient[a][lane];
    for (int b = a; b < 6; ++b, ++entry) {
      double h = 0.0;
      for (int lane = 0; lane < W; ++lane) h += hessian[entry][lane];
      sum->hessian(a, b) += h;
      if (b != a) sum->hessian(b, a) += h;
    }
  }
}

#if defined(__x86_64__)
template <typename Residual>
[[gnu::target("avx2,fma"), gnu::flatten]] void SquaredNormsAvx2(
    const MotionDerivatives& motion, const PackedColumns& columns,
    double* squared_norms) {
  SquaredNormsLoop<Residual, 4>(motion, columns, squared_norms);
}

template <typename Residual>
[[gnu::target("avx2,fma"), gnu::flatten]] void LineariseAvx2(
    const MotionDerivatives& motion, const PackedColumns& columns,
    const ceres::LossFunction* loss, NormalEquations* sum) {
  LineariseLoop<Residual, 4>(motion, columns, loss, sum);
}

inline bool HasAvx2() {
  static const bool has =
      __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return has;
}
#endif

}  // namespace packed

// Squared norm of each match's residual.
template <typename Residual>
void SumSquaredNorms(const MotionDerivatives& motion,
                     const PackedColumns& columns, double* squared_norms) {
#if defined(__x86_64__)
  if (packed::HasAvx2()) {
    packed::SquaredNormsAvx2<Residual>(motion, columns, squared_norms);
    return;
  }
#endif
  packed::SquaredNormsLoop<Residual, 2>(motion, columns, squared_norms);
}

// Adds the robustified normal equations of all matches.
template <typename Residual>
void SumNormalEquations(const MotionDerivatives& motion,
                        const PackedColumns& columns,
                        const ceres::LossFunction* loss, NormalEquations* sum) {
#if defined(__x86_64__)
  if (packed::HasAvx2()) {
    packed::LineariseAvx2<Residual>(motion, columns, loss, sum);
    return;
  }
#endif
  packed::LineariseLoop<Residual, 2>(motion, columns, loss, sum);
}

}  // namespace rgbd_pose
