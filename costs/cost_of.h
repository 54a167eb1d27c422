#pragma once

#include <string_view>
#include <vector>

#include "core/cost.h"
#include "costs/compressed_block.h"
#include "costs/match_blocks.h"
#include "costs/packed_sum.h"

namespace rgbd_pose {

// The Cost of a residual type: binding, sums and the three assemblies. A
// residual type is stateless and says
//
//   kName, kRows, kIndependentRows, kColumns
//   Pack(correspondences, i, cur_from_prev, columns) -> usable
//   Residual(motion pose, columns, r)                 for any scalars
//   Jacobian(motion derivatives, columns, r, J)       by hand
template <typename Residual>
class CostOf final : public Cost {
 public:
  std::string_view name() const override { return Residual::kName; }
  int independent_rows() const override { return Residual::kIndependentRows; }
  const std::vector<int>& matches() const override { return matches_; }

  void Bind(const Correspondences& correspondences,
            const Rigid3d& cur_from_prev) override {
    matches_.clear();
    rows_.clear();
    double columns[kColumns];
    for (size_t i = 0; i < correspondences.size(); ++i) {
      if (!Residual::Pack(correspondences, i, cur_from_prev, columns)) continue;
      matches_.push_back(static_cast<int>(i));
      rows_.insert(rows_.end(), columns, columns + kColumns);
    }
    Transpose();
  }

  void SquaredNorms(const MotionDerivatives& motion,
                    std::vector<double>* squared_norms) const override {
    squared_norms->resize(matches_.size());
    SumSquaredNorms<Residual>(motion, packed_, squared_norms->data());
  }

  void Linearise(const MotionDerivatives& motion,
                 const ceres::LossFunction* loss,
                 NormalEquations* sum) const override {
    SumNormalEquations<Residual>(motion, packed_, loss, sum);
  }

  void AddTo(Assembly assembly, const MotionOrigin& origin,
             ceres::LossFunction* loss, double* x,
             ceres::Problem* problem) const override {
    if (matches_.empty()) return;
    if (assembly == Assembly::kCompressed) {
      AddCompressed(origin, loss, x, problem);
      return;
    }
    for (size_t i = 0; i < matches_.size(); ++i) {
      const double* columns = &rows_[i * kColumns];
      ceres::CostFunction* block;
      if (assembly == Assembly::kPerMatch) {
        block = new AnalyticBlock<Residual>(origin, columns);
      } else {
        block = new OracleBlock<Residual>(
            new OracleFunctor<Residual>(origin, columns));
      }
      problem->AddResidualBlock(block, loss, x);
    }
  }

 private:
  static constexpr int kColumns = Residual::kColumns;

  void AddCompressed(const MotionOrigin& origin, ceres::LossFunction* loss,
                     double* x, ceres::Problem* problem) const {
    auto evaluate = [this, &origin, loss](const double* at,
                                          bool /*need_derivatives*/,
                                          CompressedSums<6>* sums) {
      NormalEquations sum;
      Linearise(origin.DerivativesAt(at), loss, &sum);
      *sums = {sum.hessian, sum.gradient, sum.cost};
      return true;
    };
    problem->AddResidualBlock(
        new CompressedBlock<6, decltype(evaluate)>(std::move(evaluate)),
        nullptr, x);
  }

  // rows_ (a match after the other) into packed_ (a column after the other).
  void Transpose() {
    const int size = static_cast<int>(matches_.size());
    const int lanes = PackedColumns::kMaxLanes;
    packed_.size = size;
    packed_.stride = (size + lanes - 1) / lanes * lanes;
    packed_.values.resize(static_cast<size_t>(packed_.stride) * kColumns);
    for (int i = 0; i < packed_.stride && size > 0; ++i) {
      const double* row = &rows_[(i < size ? i : size - 1) * kColumns];
      for (int k = 0; k < kColumns; ++k) {
        packed_.values[k * packed_.stride + i] = row[k];
      }
    }
  }

  std::vector<int> matches_;
  std::vector<double> rows_;  // for the assemblies that go match by match
  PackedColumns packed_;
};

}  // namespace rgbd_pose
