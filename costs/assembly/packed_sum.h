#pragma once

#include <ceres/loss_function.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

#include "core/estimation/batch_loss.h"
#include "core/estimation/motion_cost.h"
#include "core/geometry/motion.h"
#include "core/util/vector_lanes.h"
#include "costs/parts/euler_rates.h"
#include "costs/parts/point_sums.h"

// Sums over matches, several at a time: the templates of the residual types run
// on vectors of doubles, one lane per match.

namespace rgbd_pose {

// The columns of all bound matches as a structure of arrays, padded with copies
// of the last match to a multiple of kMaxLanes.
struct PackedColumns {
  std::vector<double> values;  // column k starts at k * stride
  ptrdiff_t stride = 0;
  int size = 0;

  // Removes all matches; makes room for `max_size` of them and one more lane.
  void Clear(int columns, size_t max_size) {
    stride =
        static_cast<ptrdiff_t>((max_size + kMaxLanes) / kMaxLanes * kMaxLanes);
    values.resize(stride * columns);
    size = 0;
  }

  // One match: its number in each column.
  template <size_t N>
  void Append(const std::array<double, N>& match) {
    for (size_t k = 0; k < N; ++k) values[k * stride + size] = match[k];
    ++size;
  }
  template <size_t N>
  void Read(int i, std::array<double, N>* match) const {
    for (size_t k = 0; k < N; ++k) (*match)[k] = values[k * stride + i];
  }

  // The matches from i on, one in each lane of D.
  template <typename D, size_t N>
  [[gnu::always_inline]] void Load(int i, D (&match)[N]) const {
    for (size_t k = 0; k < N; ++k) {
      std::memcpy(&match[k], &values[k * stride + i], sizeof(D));
    }
  }

  // Pads with copies of the last match, whose numbers cannot overflow.
  void Pad() {
    if (size == 0) return;
    for (size_t k = 0; k < values.size(); k += stride) {
      double* const column = &values[k];
      for (int i = size; i % kMaxLanes != 0; ++i) column[i] = column[size - 1];
    }
  }
};

namespace packed {

// Matches are weighted tile by tile: first all squared norms, then all losses
// (virtual calls, which would spill the vector registers), then all sums.
constexpr int kTile = 256;

// The squared norm of the residual of each match from `begin` (a multiple of
// kMaxLanes) to `end`. The output must have room for the padding.
template <typename Residual>
struct SquaredNormsKernel {
  template <int W>
  [[gnu::always_inline]] static void Run(const MotionDerivatives& motion,
                                         const PackedColumns& columns,
                                         int begin, int end,
                                         double* squared_norms) {
    using D = typename Lanes<W>::Type;
    for (int i = begin; i < end; i += W) {
      D m[Residual::kColumns], r[Residual::kRows];
      columns.Load(i, m);
      Residual::Residual(motion, m, r);
      D s = r[0] * r[0];
      for (int row = 1; row < Residual::kRows; ++row) s += r[row] * r[row];
      std::memcpy(squared_norms + (i - begin), &s, sizeof(D));
    }
  }
};

// Number of matches per chunk. Sums are taken over each chunk and then over the
// chunks, so the number of threads does not change a bit of the result.
constexpr int kChunk = 32 * kTile;

// The residuals of all matches, kRows each.
template <typename Residual>
struct ResidualsKernel {
  template <int W>
  [[gnu::always_inline]] static void Run(const MotionDerivatives& motion,
                                         const PackedColumns& columns,
                                         double* residuals) {
    using D = typename Lanes<W>::Type;
    for (int i = 0; i < columns.size; i += W) {
      D m[Residual::kColumns], r[Residual::kRows];
      columns.Load(i, m);
      Residual::Residual(motion, m, r);
      for (int lane = 0; lane < W && i + lane < columns.size; ++lane) {
        for (int row = 0; row < Residual::kRows; ++row) {
          residuals[(i + lane) * Residual::kRows + row] = r[row][lane];
        }
      }
    }
  }
};

// sum w J^T J and sum w J^T r, row by row of the Jacobian.
template <typename Residual, typename D>
struct RowSums {
  void Add(const MotionDerivatives& motion, const D* m, const D& weight) {
    constexpr int kRows = Residual::kRows;
    D r[kRows];
    D J[kRows][6];
    Residual::Jacobian(motion, m, r, J);
    int entry = 0;
    for (int a = 0; a < 6; ++a) {
      D wJ[kRows];
      for (int row = 0; row < kRows; ++row) wJ[row] = weight * J[row][a];
      D g = wJ[0] * r[0];
      for (int row = 1; row < kRows; ++row) g += wJ[row] * r[row];
      gradient[a] += g;
      for (int b = a; b < 6; ++b) {
        D h = wJ[0] * J[0][b];
        for (int row = 1; row < kRows; ++row) h += wJ[row] * J[row][b];
        hessian[entry++] += h;
      }
    }
  }

  void AddTo(const MotionDerivatives& /*motion*/, NormalEquations* sum) const {
    sum->hessian += SymmetricLaneSums<6>(hessian);
    for (int a = 0; a < 6; ++a) sum->gradient[a] += LaneSum(gradient[a]);
  }

  D hessian[21] = {};  // the upper triangle, row by row
  D gradient[6] = {};
};

// The same with the shortcut of point_sums.h.
template <typename Residual, typename D>
struct TermSums {
  void Add(const MotionDerivatives& motion, const D* m, const D& weight) {
    PointTerm<D> terms[kTerms];
    Residual::PointTerms(motion, m, terms);
    for (int i = 0; i < kTerms; ++i) sums[i].Add(terms[i], weight);
  }

  // d(R (X - C)) = omega x q - R dC;  d(R^T X + C) = -(R^T omega) x q + dC.
  void AddTo(const MotionDerivatives& motion, NormalEquations* sum) const {
    const Eigen::Matrix3d turn = EulerRateJacobian(motion);
    sums[0].AddTo(turn, -motion.R, sum);
    if constexpr (kTerms == 2) {
      sums[1].AddTo(-(motion.R.transpose() * turn), Eigen::Matrix3d::Identity(),
                    sum);
    }
  }

  static constexpr int kTerms = Residual::kPointTerms;
  PointSums<D> sums[kTerms];
};

// sum rho'^2 J^T r r^T J, in the place of the hessian.
template <typename Residual, typename D>
struct ScatterSums {
  void Add(const MotionDerivatives& motion, const D* m, const D& weight) {
    constexpr int kRows = Residual::kRows;
    D r[kRows];
    D J[kRows][6];
    Residual::Jacobian(motion, m, r, J);
    D g[6];
    for (int a = 0; a < 6; ++a) {
      g[a] = J[0][a] * r[0];
      for (int row = 1; row < kRows; ++row) g[a] += J[row][a] * r[row];
      g[a] *= weight;
    }
    int entry = 0;
    for (int a = 0; a < 6; ++a) {
      for (int b = a; b < 6; ++b) scatter[entry++] += g[a] * g[b];
    }
  }

  void AddTo(const MotionDerivatives& /*motion*/, NormalEquations* sum) const {
    sum->hessian += SymmetricLaneSums<6>(scatter);
  }

  D scatter[21] = {};  // the upper triangle, row by row
};

// Sums, weighted by rho', over the matches from `first` (a multiple of
// kMaxLanes) up to, not including, `last`.
template <typename Residual, template <typename, typename> typename SumsOf>
struct SumKernel {
  template <int W>
  [[gnu::always_inline]] static void Run(const MotionDerivatives& motion,
                                         const PackedColumns& columns,
                                         const ceres::LossFunction* loss,
                                         int first, int last,
                                         NormalEquations* sum) {
    using D = typename Lanes<W>::Type;
    SumsOf<Residual, D> sums;
    double cost = 0.0;
    for (int begin = first; begin < last; begin += kTile) {
      const int end = std::min(begin + kTile, last);
      alignas(64) double squared_norms[kTile + kMaxLanes];
      alignas(64) double weights[kTile + kMaxLanes];  // rho', 0 for padding
      SquaredNormsKernel<Residual>::template Run<W>(motion, columns, begin, end,
                                                    squared_norms);
      cost += Weigh(loss, squared_norms, end - begin, weights);
      for (int i = end - begin; i % W != 0; ++i) weights[i] = 0.0;
      for (int i = begin; i < end; i += W) {
        D m[Residual::kColumns], weight;
        columns.Load(i, m);
        std::memcpy(&weight, weights + (i - begin), sizeof(D));
        sums.Add(motion, m, weight);
      }
    }
    sum->cost += 0.5 * cost;
    sums.AddTo(motion, sum);
  }
};

// The robustified normal equations.
template <typename Residual, typename D>
using NormalSums =
    std::conditional_t<kHas<PointTermsOf, Residual>, TermSums<Residual, D>,
                       RowSums<Residual, D>>;
template <typename Residual>
using LineariseKernel = SumKernel<Residual, NormalSums>;

}  // namespace packed
}  // namespace rgbd_pose
