#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/estimation/motion_cost.h"
#include "core/util/parallel_for.h"
#include "core/util/vector_lanes.h"
#include "costs/assembly/autodiff_jacobian.h"
#include "costs/assembly/cost_blocks.h"
#include "costs/assembly/packed_sum.h"

namespace rgbd_pose {

// Detect optional functions of a residual type.
template <typename Residual>
using DegreesOf = decltype(&Residual::Degrees);
template <typename Residual>
using InlierLimitOf = decltype(&Residual::InlierLimit);

// Common part of all costs, whatever their blocks are made from: the blocks as
// columns, the sums over them and the three assemblies. A derived class fills
// the columns with BeginBlocks, AddBlock, EndBlocks.
template <typename Type>
class PackedCost : public MotionCost {
 protected:
  // Gets an automatic Jacobian if the type has none of its own.
  using Residual = std::conditional_t<kHas<JacobianOf, Type>, Type,
                                      WithAutodiffJacobian<Type>>;

 public:
  std::string_view name() const override { return Residual::kName; }
  int degrees_of_freedom() const override {
    return Residual::kDegreesOfFreedom;
  }
  const std::vector<int>& matches() const override { return matches_; }
  const std::vector<int>& degrees() const override { return degrees_; }

  int num_residuals() const override { return Residual::kRows; }
  bool is_whitened() const override { return Residual::kIsWhitened; }

  double InlierLimit(int k) const override {
    if constexpr (kHas<InlierLimitOf, Residual>) {
      Block columns;
      packed_.Read(k, &columns);
      return Residual::InlierLimit(columns.data());
    }
    return MotionCost::InlierLimit(k);
  }

  void Residuals(const MotionDerivatives& motion,
                 std::vector<double>* residuals) const override {
    residuals->resize(matches_.size() * Residual::kRows);
    RunVectorised<packed::ResidualsKernel<Residual>>(motion, packed_,
                                                     residuals->data());
  }

  void SquaredNorms(const MotionDerivatives& motion,
                    std::vector<double>* squared_norms) const override {
    squared_norms->resize(packed_.stride);
    RunVectorised<packed::SquaredNormsKernel<Residual>>(
        motion, packed_, 0, packed_.size, squared_norms->data());
    squared_norms->resize(matches_.size());
  }

  void Linearise(const MotionDerivatives& motion,
                 const ceres::LossFunction* loss,
                 NormalEquations* sum) const override {
    using Kernel = packed::LineariseKernel<Residual>;
    if (packed_.size <= packed::kChunk) {
      RunVectorised<Kernel>(motion, packed_, loss, 0, packed_.size, sum);
      return;
    }
    ParallelFor(static_cast<int>(chunks_.size()), threads_, [&](int i) {
      const int first = i * packed::kChunk;
      const int last = std::min(first + packed::kChunk, packed_.size);
      chunks_[i] = NormalEquations();
      RunVectorised<Kernel>(motion, packed_, loss, first, last, &chunks_[i]);
    });
    for (const NormalEquations& chunk : chunks_) {
      sum->hessian += chunk.hessian;
      sum->gradient += chunk.gradient;
      sum->cost += chunk.cost;
    }
  }

  void AddScoreOuterProduct(const MotionDerivatives& motion,
                            const ceres::LossFunction* loss,
                            MotionMatrix* scatter) const override {
    NormalEquations sum;
    RunVectorised<packed::SumKernel<Residual, packed::ScatterSums>>(
        motion, packed_, loss, 0, packed_.size, &sum);
    *scatter += sum.hessian;
  }

  void AddTo(Assembly assembly, const LinearizationPoint& origin,
             ceres::LossFunction* loss, double* x,
             ceres::Problem* problem) override {
    if (matches_.empty()) return;
    if (assembly == Assembly::kCompressed) {
      block_.emplace(MotionSums(this, &origin, loss));
      problem->AddResidualBlock(&*block_, nullptr, x);
      return;
    }
    rows_.resize(matches_.size());
    for (size_t i = 0; i < matches_.size(); ++i) {
      packed_.Read(i, &rows_[i]);
      const double* const columns = rows_[i].data();
      ceres::CostFunction* block;
      if (assembly == Assembly::kPerMatch) {
        block = new AnalyticBlock<Residual>(origin, columns);
      } else {
        block = new OracleBlock<Residual>(
            new OracleFunctor<Residual>{origin, columns});
      }
      problem->AddResidualBlock(block, loss, x);
    }
  }

 protected:
  // The columns of a block.
  using Block = std::array<double, Residual::kColumns>;

  // See FramePair::threads.
  void SetThreads(int threads) { threads_ = threads; }

  const PackedColumns& columns() const { return packed_; }

  // Removes all blocks and reserves memory for max_blocks. The caller may write
  // blocks without a match, and their number, directly to the returned columns.
  PackedColumns* BeginBlocks(size_t max_blocks) {
    packed_.Clear(Residual::kColumns, max_blocks);
    matches_.clear();
    degrees_.clear();
    return &packed_;
  }

  // `match` as in MotionCost::matches.
  void AddBlock(const Block& columns, int match) {
    packed_.Append(columns);
    matches_.push_back(match);
    if constexpr (kHas<DegreesOf, Residual>) {
      degrees_.push_back(Residual::Degrees(columns.data()));
    }
  }

  // To be called after the last block.
  void EndBlocks() {
    matches_.resize(packed_.size, -1);
    degrees_.resize(packed_.size, Residual::kDegreesOfFreedom);
    packed_.Pad();
    chunks_.resize((packed_.size + packed::kChunk - 1) / packed::kChunk);
  }

 private:
  std::vector<int> matches_;
  std::vector<int> degrees_;
  PackedColumns packed_;
  int threads_ = 1;
  mutable std::vector<NormalEquations> chunks_;  // see Linearise
  // The columns match by match, for the assemblies that need them so.
  std::vector<Block> rows_;
  std::optional<MotionBlock> block_;
};

}  // namespace rgbd_pose
