#include "core/factors/check_factor.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

using factors::BlockKind;

// States are drawn again where a residual cannot be evaluated, at most so many
// times as often.
constexpr int kMaxTries = 100;

// The largest share of states near which a residual may jump, as rotations do
// at half a turn: there, differences tell nothing.
constexpr double kMaxJumps = 0.05;

// Longer lists of wrong entries are cut.
constexpr int kMaxLines = 12;

using State = std::vector<Eigen::VectorXd>;

// Residuals, and the Jacobian in the tangents of all blocks side by side.
struct Evaluated {
  bool ok = false;
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
};

bool HasBlocks(const ceres::CostFunction* function,
               const std::vector<BlockKind>& kinds) {
  return function != nullptr &&
         std::equal(kinds.begin(), kinds.end(),
                    function->parameter_block_sizes().begin(),
                    function->parameter_block_sizes().end(),
                    [](const BlockKind& kind, int32_t size) {
                      return kind.size == size;
                    });
}

// Throws InputError if the parts of a factor do not fit together, where an
// evaluation would write beyond its memory, or if the options do not fit it.
void RequireFitting(const CheckableFactor& factor,
                    const CheckFactorOptions& options) {
  if (!HasBlocks(factor.by_hand.get(), factor.kinds) ||
      !HasBlocks(factor.by_autodiff.get(), factor.kinds) ||
      factor.by_hand->num_residuals() != factor.by_autodiff->num_residuals()) {
    throw InputError(factor.name +
                     ": both functions of a CheckableFactor must have the "
                     "blocks in `kinds` and equally many residuals, as from "
                     "MakeCheckable");
  }
  if (options.samples < 1) {
    throw InputError("CheckFactorOptions::samples must be at least 1, not " +
                     std::to_string(options.samples));
  }
  const auto& near = options.near.empty() ? factor.near : options.near;
  if (!near.empty() &&
      !std::equal(factor.kinds.begin(), factor.kinds.end(), near.begin(),
                  near.end(), [](const BlockKind& kind, const auto& block) {
                    return kind.size == static_cast<int>(block.size());
                  })) {
    throw InputError("CheckFactorOptions::near must have the " +
                     std::to_string(factor.kinds.size()) + " blocks of " +
                     factor.name);
  }
}

class Checker {
 public:
  Checker(const CheckableFactor& factor, const CheckFactorOptions& options)
      : name_(factor.name),
        kinds_(factor.kinds),
        by_hand_(*factor.by_hand),
        by_autodiff_(*factor.by_autodiff),
        near_(options.near.empty() ? factor.near : options.near),
        options_(options),
        random_(options.seed) {
    for (size_t i = 0; i < kinds_.size(); ++i) {
      for (int k = 0; k < kinds_[i].tangent; ++k) {
        columns_.push_back({static_cast<int>(i), k});
      }
    }
    rows_ = by_hand_.num_residuals();
    worst_.resize(rows_ * columns_.size());
    for (const BlockKind& kind : kinds_) errors_.push_back({kind.name});
    wrong_residuals_.resize(rows_);
    while (valid_ < options_.samples && tries_ < kMaxTries * options_.samples) {
      ++tries_;
      valid_ += CheckAt(RandomState());
    }
  }

  // By block.
  std::vector<FactorErrors> Errors() const {
    std::vector<FactorErrors> errors = errors_;
    if (valid_ == options_.samples && refused_ == 0) return errors;
    for (FactorErrors& block : errors) block.autodiff = NAN;
    return errors;
  }

  // A line for each mistake.
  std::string Text() const {
    std::vector<std::string> lines;
    if (valid_ < options_.samples) {
      lines.push_back("could be evaluated at only " + std::to_string(valid_) +
                      " of " + std::to_string(tries_) +
                      " random states: set CheckFactorOptions::near");
    }
    if (refused_ > 0) {
      lines.push_back("Jacobian returns false at " + std::to_string(refused_) +
                      " states at which Residual returns true");
    }
    for (int row = 0; row < rows_; ++row) AddLines(row, &lines);
    std::string text;
    for (int i = 0; i < static_cast<int>(lines.size()); ++i) {
      if (i == kMaxLines) {
        text += name_ + ": and " + std::to_string(lines.size() - kMaxLines) +
                " more\n";
        break;
      }
      text += name_ + ": " + lines[i] + "\n";
    }
    return text;
  }

 private:
  struct Column {
    int block;
    int tangent;
  };
  // The values where an entry differs most, in tolerances.
  struct Worst {
    double error = 0.0;
    double hand = 0.0, autodiff = 0.0, differences = 0.0;
    int states = 0;  // with an error above the tolerance
    int jumps = 0;   // states near which the residual is not smooth
  };

  State RandomState() {
    State state;
    for (size_t i = 0; i < kinds_.size(); ++i) {
      if (near_.empty()) {
        state.push_back(kinds_[i].random(&random_));
        continue;
      }
      Eigen::VectorXd d(kinds_[i].tangent), moved(kinds_[i].size);
      for (double& value : d) {
        value = random_.Uniform(-options_.spread, options_.spread);
      }
      kinds_[i].plus(near_[i].data(), d.data(), moved.data());
      state.push_back(moved);
    }
    return state;
  }

  Evaluated Evaluate(const ceres::CostFunction& function, const State& state,
                     bool with_jacobian) const {
    using RowMajor =
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Evaluated out;
    out.r = Eigen::VectorXd::Zero(rows_);
    std::vector<const double*> x;
    std::vector<RowMajor> ambient;
    std::vector<double*> jacobians;
    for (const Eigen::VectorXd& block : state) {
      x.push_back(block.data());
      ambient.emplace_back(rows_, block.size());
    }
    for (RowMajor& block : ambient) jacobians.push_back(block.data());
    out.ok = function.Evaluate(x.data(), out.r.data(),
                               with_jacobian ? jacobians.data() : nullptr);
    if (!out.ok || !with_jacobian) return out;
    out.J.resize(rows_, columns_.size());
    int first = 0;
    for (size_t i = 0; i < state.size(); ++i) {
      out.J.middleCols(first, kinds_[i].tangent) =
          ambient[i] * kinds_[i].plus_jacobian(x[i]);
      first += kinds_[i].tangent;
    }
    return out;
  }

  // d r / d(one direction). Two steps cancel the errors of second order; where
  // they disagree, the residual jumps or has a kink nearby: NaN.
  Eigen::VectorXd Difference(const State& state, const Column& column) const {
    constexpr double kStep = 1e-3;
    const auto along = [&](double step) -> Eigen::VectorXd {
      Eigen::VectorXd d = Eigen::VectorXd::Zero(kinds_[column.block].tangent);
      const auto residual_at = [&](double value) {
        State moved = state;
        d[column.tangent] = value;
        kinds_[column.block].plus(state[column.block].data(), d.data(),
                                  moved[column.block].data());
        return Evaluate(by_autodiff_, moved, false).r;
      };
      return (residual_at(step) - residual_at(-step)) / (2.0 * step);
    };
    constexpr double kSmooth = 1e-3;
    const Eigen::VectorXd half = along(0.5 * kStep), whole = along(kStep);
    Eigen::VectorXd result = (4.0 * half - whole) / 3.0;
    for (int row = 0; row < rows_; ++row) {
      const double size = std::max(1.0, std::abs(half[row]));
      if (!(std::abs(half[row] - whole[row]) < kSmooth * size)) {
        result[row] = NAN;
      }
    }
    return result;
  }

  // Returns false if the residual cannot be evaluated there.
  bool CheckAt(const State& state) {
    const Evaluated plain = Evaluate(by_autodiff_, state, false);
    if (!plain.ok) return false;
    const Evaluated autodiff = Evaluate(by_autodiff_, state, true);
    const Evaluated hand = Evaluate(by_hand_, state, true);
    if (!hand.ok) {
      ++refused_;
      return true;
    }
    Eigen::MatrixXd differences(rows_, columns_.size());
    for (size_t k = 0; k < columns_.size(); ++k) {
      differences.col(k) = Difference(state, columns_[k]);
    }
    for (int row = 0; row < rows_; ++row) {
      Update(std::abs(hand.r[row] - plain.r[row]) /
                 std::max(1.0, std::abs(plain.r[row])) /
                 options_.autodiff_tolerance,
             hand.r[row], plain.r[row], 0.0, &wrong_residuals_[row]);
      double size = autodiff.J.row(row).lpNorm<Eigen::Infinity>();
      if (!(size > 0.0)) size = 1.0;
      for (size_t k = 0; k < columns_.size(); ++k) {
        const double by_hand = hand.J(row, k), jet = autodiff.J(row, k),
                     difference = differences(row, k);
        Worst* const worst = &worst_[row * columns_.size() + k];
        FactorErrors* const block = &errors_[columns_[k].block];
        const double off = std::abs(by_hand - jet) / size;
        double error = off / options_.autodiff_tolerance;
        RaiseTo(off, &block->autodiff);
        if (std::isnan(difference)) {
          ++worst->jumps;
        } else {
          RaiseTo(std::abs(by_hand - difference) / size, &block->differences);
          error = std::max(error, std::abs(jet - difference) / size /
                                      options_.difference_tolerance);
        }
        Update(error, by_hand, jet, difference, worst);
      }
    }
    return true;
  }

  // A NaN stays.
  static void RaiseTo(double error, double* largest) {
    if (!std::isnan(*largest) && !(error <= *largest)) *largest = error;
  }

  static void Update(double error, double hand, double autodiff,
                     double differences, Worst* worst) {
    if (error <= 1.0) return;  // false for NaN
    ++worst->states;
    if (worst->states > 1 && !(error > worst->error)) return;
    worst->error = error;
    worst->hand = hand;
    worst->autodiff = autodiff;
    worst->differences = differences;
  }

  void AddLines(int row, std::vector<std::string>* lines) const {
    char text[200];
    const std::string where = "row " + std::to_string(row);
    const auto at = [&](const Worst& worst) {
      return " (at " + std::to_string(worst.states) + " of " +
             std::to_string(options_.samples) + " states)";
    };
    if (const Worst& worst = wrong_residuals_[row]; worst.states > 0) {
      std::snprintf(text, sizeof(text),
                    ": Jacobian fills in the residual %.6g, Residual %.6g",
                    worst.hand, worst.autodiff);
      lines->push_back(where + text + at(worst));
    }
    for (size_t k = 0; k < columns_.size(); ++k) {
      const Worst& worst = worst_[row * columns_.size() + k];
      const BlockKind& kind = kinds_[columns_[k].block];
      const std::string entry =
          where + ", block " + std::to_string(columns_[k].block) + " (" +
          kind.name + "), " + kind.name_of(columns_[k].tangent);
      if (worst.jumps > kMaxJumps * options_.samples) {
        lines->push_back(entry + ": not smooth at " +
                         std::to_string(worst.jumps) + " of " +
                         std::to_string(options_.samples) + " states");
        continue;
      }
      if (worst.states == 0) continue;
      std::snprintf(text, sizeof(text),
                    "%.6g by hand, %.6g by autodiff, %.6g by differences",
                    worst.hand, worst.autodiff, worst.differences);
      lines->push_back(entry + ": " + text + at(worst));
    }
  }

  const std::string& name_;
  const std::vector<BlockKind>& kinds_;
  const ceres::CostFunction& by_hand_;
  const ceres::CostFunction& by_autodiff_;
  const std::vector<std::vector<double>>& near_;
  const CheckFactorOptions& options_;
  FactorSampler random_;
  std::vector<Column> columns_;
  int rows_ = 0;
  int valid_ = 0, tries_ = 0;           // states
  std::vector<FactorErrors> errors_;    // by block
  std::vector<Worst> worst_;            // row by row
  std::vector<Worst> wrong_residuals_;  // one per row
  int refused_ = 0;
};

}  // namespace

std::string CheckFactor(const CheckableFactor& factor,
                        const CheckFactorOptions& options) {
  RequireFitting(factor, options);
  return Checker(factor, options).Text();
}

std::vector<FactorErrors> ErrorsOfFactor(const CheckableFactor& factor,
                                         const CheckFactorOptions& options) {
  RequireFitting(factor, options);
  return Checker(factor, options).Errors();
}

}  // namespace rgbd_pose
