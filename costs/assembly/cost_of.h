#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/estimation/motion_cost.h"
#include "core/util/lane_math.h"
#include "core/util/parallel_for.h"
#include "core/util/vector_lanes.h"
#include "costs/assembly/autodiff_jacobian.h"
#include "costs/assembly/match_blocks.h"
#include "costs/assembly/motion_block.h"
#include "costs/assembly/packed_sum.h"
#include "costs/parts/cost_input.h"

namespace rgbd_pose {

// The MotionCost of a residual type over matches: binding, sums and the three
// assemblies. A residual type is stateless and says
//
//   kName, kRows, kIndependentRows, kColumns
//   kIsWhitened                                   see MotionCost::is_whitened
//   Pack(input, i, columns) -> usable             of match i
//   Residual(motion pose, columns, r)             for any scalars
//
// and, where it has to be fast (costs/assembly/autodiff_jacobian.h does it
// otherwise),
//
//   Jacobian(motion derivatives, columns, r, J)   by hand
//
// A type whose weights or choice of matches depend on the motion that Pack is
// given says when to pack again by
//
//   kAssociation                                  see MotionCost::association
//
// A type whose matches may lack measurements tells how many there are by
//
//   Degrees(columns)                              see MotionCost::degrees
//
// and one that is not whitened may tell how long right residuals get by
//
//   InlierLimit(columns)                          see MotionCost::InlierLimit
//
// A type that packs the prior instead of matches says so by kIsPrior; it is
// called with i = 0 if there is a prior.
template <typename Residual, typename = void>
struct IsPrior : std::false_type {};
template <typename Residual>
struct IsPrior<Residual, std::void_t<decltype(Residual::kIsPrior)>>
    : std::true_type {};

// How a residual type is associated: its kAssociation, else once.
template <typename Residual, typename = void>
struct HasAssociation : std::false_type {};
template <typename Residual>
struct HasAssociation<Residual, std::void_t<decltype(Residual::kAssociation)>>
    : std::true_type {};

template <typename Residual, typename = void>
struct HasDegrees : std::false_type {};
template <typename Residual>
struct HasDegrees<Residual, std::void_t<decltype(&Residual::Degrees)>>
    : std::true_type {};

template <typename Residual, typename = void>
struct HasInlierLimit : std::false_type {};
template <typename Residual>
struct HasInlierLimit<Residual, std::void_t<decltype(&Residual::InlierLimit)>>
    : std::true_type {};

// Of a residual type as described above.
template <typename Type>
class CostOf final : public MotionCost {
  using Residual = std::conditional_t<HasJacobian<Type>::value, Type,
                                      WithAutodiffJacobian<Type>>;

 public:
  std::string_view name() const override { return Residual::kName; }
  int independent_rows() const override { return Residual::kIndependentRows; }
  const std::vector<int>& matches() const override { return matches_; }
  const std::vector<int>& degrees() const override { return degrees_; }

  int rows() const override { return Residual::kRows; }
  bool is_whitened() const override { return Residual::kIsWhitened; }

  double InlierLimit(int k) const override {
    if constexpr (HasInlierLimit<Residual>()) {
      double columns[kColumns];
      for (int i = 0; i < kColumns; ++i) {
        columns[i] = packed_.values[i * packed_.stride + k];
      }
      return Residual::InlierLimit(columns);
    }
    return MotionCost::InlierLimit(k);
  }

  int scale_group() const override {
    return IsPrior<Residual>() ? kExactSigmas : 0;
  }

  Association association() const override {
    if constexpr (HasAssociation<Residual>()) return Residual::kAssociation;
    return Association::kOnce;
  }

  // Keeps matches only where they have to be packed again.
  void Bind(const PairData& pair) override {
    threads_ = pair.threads;
    if (association() != Association::kOnce) {
      if (pair.matches != nullptr) {
        kept_ = *pair.matches;
      } else {
        kept_.Clear();
      }
      return;
    }
    static const Correspondences none;
    PackAll({pair.matches != nullptr ? *pair.matches : none, Rigid3d(),
             pair.prior});
  }

  void Associate(const Rigid3d& cur_from_prev) override {
    if (association() != Association::kOnce) PackAll({kept_, cur_from_prev});
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
    RunVectorised<packed::SquaredNormsKernel<Residual>>(motion, packed_,
                                                        squared_norms->data());
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
      NormalEquations* const chunk = &chunks_[i];
      RunVectorised<Kernel>(motion, packed_, loss, first, last, chunk);
    });
    for (const NormalEquations& chunk : chunks_) {
      sum->hessian += chunk.hessian;
      sum->gradient += chunk.gradient;
      sum->cost += chunk.cost;
    }
  }

  void AddScatter(const MotionDerivatives& motion,
                  const ceres::LossFunction* loss,
                  MotionMatrix* scatter) const override {
    RunVectorised<packed::ScatterKernel<Residual>>(motion, packed_, loss,
                                                   scatter);
  }

  void AddTo(Assembly assembly, const MotionOrigin& origin,
             ceres::LossFunction* loss, double* x,
             ceres::Problem* problem) override {
    if (matches_.empty()) return;
    if (assembly == Assembly::kCompressed) {
      block_.emplace(MotionSums(this, &origin, loss));
      problem->AddResidualBlock(&*block_, nullptr, x);
      return;
    }
    Unpack();
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

  void PackAll(const CostInput& input) {
    const size_t count = Count(input);
    packed_.stride =
        static_cast<ptrdiff_t>((count + kMaxLanes - 1) / kMaxLanes * kMaxLanes);
    packed_.values.resize(packed_.stride * kColumns);
    matches_.clear();
    degrees_.clear();
    double columns[kColumns];
    for (size_t i = 0; i < count; ++i) {
      if (!Residual::Pack(input, i, columns)) continue;
      Store(matches_.size(), columns);
      matches_.push_back(IsPrior<Residual>() ? -1 : static_cast<int>(i));
      degrees_.push_back(Degrees(columns));
    }
    packed_.size = static_cast<int>(matches_.size());
    Pad();
    chunks_.resize((packed_.size + packed::kChunk - 1) / packed::kChunk);
  }

  static size_t Count(const CostInput& input) {
    if (IsPrior<Residual>()) return input.prior != nullptr ? 1 : 0;
    return input.matches.size();
  }

  static int Degrees(const double* columns) {
    if constexpr (HasDegrees<Residual>()) return Residual::Degrees(columns);
    return Residual::kIndependentRows;
  }

  void Store(size_t i, const double* columns) {
    for (int k = 0; k < kColumns; ++k) {
      packed_.values[k * packed_.stride + i] = columns[k];
    }
  }

  // Fills the last lanes by copies of the last match: no numbers that could
  // overflow there.
  void Pad() {
    const size_t size = matches_.size();
    for (size_t i = size; size > 0 && i % kMaxLanes != 0; ++i) {
      for (int k = 0; k < kColumns; ++k) {
        double* column = &packed_.values[k * packed_.stride];
        column[i] = column[size - 1];
      }
    }
  }

  // A match after the other, for the assemblies that go match by match.
  void Unpack() {
    rows_.resize(matches_.size() * kColumns);
    for (size_t i = 0; i < matches_.size(); ++i) {
      for (int k = 0; k < kColumns; ++k) {
        rows_[i * kColumns + k] = packed_.values[k * packed_.stride + i];
      }
    }
  }

  Correspondences kept_;  // see Bind
  std::vector<int> matches_;
  std::vector<int> degrees_;
  PackedColumns packed_;
  int threads_ = 1;
  mutable std::vector<NormalEquations> chunks_;  // see Linearise
  std::vector<double> rows_;                     // see Unpack
  std::optional<MotionBlock> block_;
};

// The cost of a residual type of your own; costs/cost_factory.h makes those of
// this project by name.
template <typename Residual>
std::unique_ptr<MotionCost> MakeCost() {
  return std::make_unique<CostOf<Residual>>();
}

}  // namespace rgbd_pose
