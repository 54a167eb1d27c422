// The path of a flying robot from its inertial sensor and every second position
// that a laser tracker measured, in a ceres::Problem of your own; the other
// positions are predicted and compared:
//
//   inertial_path FOLDER    (EuRoC, MH_01: imu0.csv, leica0.csv)
#include <ceres/ceres.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "rgbd_pose/core/factors/factor.h"
#include "rgbd_pose/core/factors/pose_manifold.h"
#include "rgbd_pose/core/inertial/imu_buffer.h"
#include "rgbd_pose/core/util/input_error.h"
#include "rgbd_pose/core/util/text_file.h"
#include "rgbd_pose/costs/factors/inertial.h"

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using rgbd_pose::PoseOf;

// The data sheet of the sensor, an ADIS16448, says 1.7e-4, 2e-3, 1.9e-5 and
// 3e-3, and it does keep to this while it stands. Rotors shake it, which takes
// 3 and 10 times the densities; while it warms up, its gyroscopes walk faster.
const rgbd_pose::ImuNoise kNoise = {5e-4, 2e-2, 1e-4, 3e-3};
const Vector3d kGravity(0.0, 0.0, -9.81);
const Vector3d kPrism(7.48903e-2, -1.84772e-2, -1.20209e-1);  // on the body

// The tracker: the position of its axes, the noise of its angles and, at rest,
// of its distance. In motion distances, not angles, are from a moment that is
// up to 25 ms off; all this shows in the residuals.
const Vector3d kTracker(0.04, 0.46, 1.39);
constexpr double kSigma = 0.5e-3;               // m
constexpr double kDistanceTime = 0.05 / 3.464;  // s

struct Position {
  double stamp;  // of the tracker's clock, s
  Vector3d prism;
  Matrix3d sqrt_information;
};

struct State {
  rgbd_pose::PoseVector pose;
  Vector3d velocity;
  rgbd_pose::ImuBiasVector bias;
};

// A measured position, at a moment that is `delay` (s) after that of the pose.
struct PrismFactor {
  static constexpr char kName[] = "prism";
  using Blocks =
      rgbd_pose::BlockList<rgbd_pose::PoseBlock, rgbd_pose::VelocityBlock,
                           rgbd_pose::VectorBlock<1>>;
  static constexpr int kRows = 3;

  Position measured;

  template <typename T>
  bool Residual(const PoseOf<T>& body, const Eigen::Matrix<T, 3, 1>& velocity,
                const Eigen::Matrix<T, 1, 1>& delay, T* r) const {
    const Eigen::Matrix<T, 3, 1> lever = kPrism.cast<T>();
    Eigen::Map<Eigen::Matrix<T, 3, 1>> whitened(r);
    whitened = measured.sqrt_information.cast<T>() *
               (body.q * lever + body.p + delay[0] * velocity -
                measured.prism.cast<T>());
    return true;
  }
};

// Rows of numbers; a spreadsheet left others at the end.
std::vector<std::vector<double>> Rows(const std::string& path, size_t columns) {
  std::vector<std::vector<double>> rows;
  for (const rgbd_pose::TextLine& line : rgbd_pose::ReadTextTable(path)) {
    if (line.words.size() != columns) continue;
    rows.emplace_back();
    for (const std::string& word : line.words) {
      rows.back().push_back(
          rgbd_pose::ParseNumber(word, path, line.number, "a number"));
    }
    rows.back()[0] *= 1e-9;  // nanoseconds
  }
  return rows;
}

std::vector<Position> ReadPositions(const std::string& path) {
  std::vector<Position> positions;
  for (const std::vector<double>& row : Rows(path, 4)) {
    positions.push_back({row[0], {row[1], row[2], row[3]}, Matrix3d::Zero()});
  }
  for (size_t i = 0; i < positions.size(); ++i) {
    const Position& before = positions[i < 2 ? 0 : i - 2];
    const Position& after = positions[std::min(i + 2, positions.size() - 1)];
    const Vector3d sight = (positions[i].prism - kTracker).normalized();
    const double speed =
        sight.dot(after.prism - before.prism) / (after.stamp - before.stamp);
    const double sigma = std::hypot(kSigma, kDistanceTime * speed);
    const Matrix3d along = sight * sight.transpose();
    positions[i].sqrt_information =
        (Matrix3d::Identity() - along) / kSigma + along / sigma;
  }
  return positions;
}

// Position k of a path belongs to state k; odd ones are held out.
class Path {
 public:
  Path(const rgbd_pose::ImuBuffer& imu, std::vector<Position> positions)
      : imu_(&imu), positions_(std::move(positions)) {}

  // First the start, for which four headings are tried, then all. Each time the
  // samples are integrated again, with the delay and the biases found before.
  void Solve() {
    constexpr size_t kStart = 200;
    Path best = *this;
    double least = INFINITY;
    for (int quarter = 0; quarter < 4; ++quarter) {
      Path path = *this;
      path.Begin(quarter * M_PI / 2.0);
      for (int round = 0; round < 3; ++round) path.SolveFirst(kStart);
      if (path.cost_ < least) {
        least = path.cost_;
        best = path;
      }
    }
    for (int round = 0; round < 3; ++round) best.SolveFirst(positions_.size());
    *this = best;
  }

  void Print() const {
    double across = 0.0, along = 0.0;
    int held_out = 0;
    for (size_t k = 1; k < states_.size(); k += 2, ++held_out) {
      const Vector3d error =
          rgbd_pose::RigidOf(states_[k].pose) * kPrism - positions_[k].prism;
      const Vector3d sight = (positions_[k].prism - kTracker).normalized();
      across += (error - sight * sight.dot(error)).squaredNorm() / 2.0;
      along += std::pow(sight.dot(positions_[k].sqrt_information * error), 2.0);
    }
    std::printf("poses %zu\ndelay_ms %.1f\n", states_.size(), 1e3 * delay_);
    std::printf("held_out %d\nacross_mm %.2f\nalong_sigmas %.2f\n", held_out,
                1e3 * std::sqrt(across / held_out),
                std::sqrt(along / held_out));
    std::printf("factors_chi2 %.0f\nfactors_freedom %.0f\n", factors_chi2_,
                factors_freedom_);
    std::printf("positions_chi2 %.0f\npositions_freedom %.0f\n",
                positions_chi2_, positions_freedom_);
    PrintBias("first_bias", states_.front(), first_covariance_);
    PrintBias("last_bias", states_.back(), last_covariance_);
  }

  // How much the first bias of a later path differs, squared, in sigmas.
  double BiasDistance(const Path& later) const {
    const rgbd_pose::ImuBiasVector d =
        later.states_.front().bias - states_.back().bias;
    return d.dot((last_covariance_ + later.first_covariance_).inverse() * d);
  }

 private:
  using BiasMatrix = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

  static void PrintBias(const char* name, const State& state,
                        const BiasMatrix& covariance) {
    std::printf("%s", name);
    for (int i = 0; i < 6; ++i) {
      std::printf(" %.5f+-%.5f", state.bias[i], std::sqrt(covariance(i, i)));
    }
    std::printf("\n");
  }

  double Time(size_t k) const { return positions_[k].stamp + delay_; }

  // Upright by the acceleration of the first second.
  void Begin(double heading) {
    Vector3d up = Vector3d::Zero();
    for (const auto& sample : imu_->Between(Time(0), Time(0) + 1.0)) {
      up += sample.accel;
    }
    const Eigen::Quaterniond q =
        Eigen::AngleAxisd(heading, Vector3d::UnitZ()) *
        Eigen::Quaterniond::FromTwoVectors(up, Vector3d::UnitZ());
    states_ = {Guess(0, q, rgbd_pose::ImuBiasVector::Zero())};
  }

  State Guess(size_t k, const Eigen::Quaterniond& q,
              const rgbd_pose::ImuBiasVector& bias) const {
    const size_t before = k < 2 ? 0 : k - 2;
    const size_t after = std::min(k + 2, positions_.size() - 1);
    State state;
    state.pose << q.coeffs(), positions_[k].prism - q * kPrism;
    state.velocity = (positions_[after].prism - positions_[before].prism) /
                     (Time(after) - Time(before));
    state.bias = bias;
    return state;
  }

  void SolveFirst(size_t count) {
    std::vector<rgbd_pose::PreintegratedMotion> motions;
    for (size_t k = 0; k + 1 < count; ++k) {
      motions.push_back(rgbd_pose::Preintegrate(
          imu_->Between(Time(k), Time(k + 1)), states_[k].bias, kNoise));
      if (k + 1 < states_.size()) continue;
      const Eigen::Quaterniond q = rgbd_pose::RigidOf(states_[k].pose).rotation;
      states_.push_back(
          Guess(k + 1, q * motions[k].start_from_end, states_[k].bias));
    }
    ceres::Problem problem;
    double more_delay = 0.0;
    std::vector<ceres::ResidualBlockId> factors, measured;
    for (State& state : states_)
      rgbd_pose::AddPose(state.pose.data(), &problem);
    for (size_t k = 0; k < count; ++k) {
      State& i = states_[k];
      if (k % 2 == 0) {
        measured.push_back(problem.AddResidualBlock(
            rgbd_pose::MakeFactor(PrismFactor{positions_[k]}), nullptr,
            i.pose.data(), i.velocity.data(), &more_delay));
      }
      if (k + 1 == count) break;
      State& j = states_[k + 1];
      factors.push_back(problem.AddResidualBlock(
          rgbd_pose::MakeFactor(
              rgbd_pose::InertialFactor(motions[k], kGravity)),
          nullptr, i.pose.data(), i.velocity.data(), i.bias.data(),
          j.pose.data(), j.velocity.data(), j.bias.data()));
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.max_num_iterations = 100;
    options.function_tolerance = 1e-9;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    cost_ = summary.final_cost;
    if (count == positions_.size()) {
      Judge(factors, measured, &more_delay, &problem);
    }
    delay_ += more_delay;
  }

  // How well residuals fit their noise. Of the estimated numbers, measured
  // positions determine the trace of their part of the hat matrix, factors the
  // rest; about every twentieth position stands for all.
  void Judge(const std::vector<ceres::ResidualBlockId>& factors,
             const std::vector<ceres::ResidualBlockId>& measured, double* delay,
             ceres::Problem* problem) {
    const auto chi2 = [&](const std::vector<ceres::ResidualBlockId>& blocks) {
      ceres::Problem::EvaluateOptions options;
      options.residual_blocks = blocks;
      double cost = 0.0;
      problem->Evaluate(options, &cost, nullptr, nullptr, nullptr);
      return 2.0 * cost;
    };
    factors_chi2_ = chi2(factors);
    positions_chi2_ = chi2(measured);

    std::vector<std::pair<const double*, const double*>> wanted;
    const double* const first = states_.front().bias.data();
    const double* const last = states_.back().bias.data();
    wanted = {{first, first}, {last, last}, {delay, delay}};
    for (size_t k = 0; k < states_.size(); k += 20) {
      wanted.push_back({states_[k].pose.data(), states_[k].pose.data()});
    }
    ceres::Covariance covariance{ceres::Covariance::Options()};
    if (!covariance.Compute(wanted, problem)) {
      throw rgbd_pose::InputError("the path is not determined");
    }
    covariance.GetCovarianceBlock(first, first, first_covariance_.data());
    covariance.GetCovarianceBlock(last, last, last_covariance_.data());
    double trace = 0.0;
    int sampled = 0;
    for (size_t k = 0; k < states_.size(); k += 20, ++sampled) {
      const double* const pose = states_[k].pose.data();
      Eigen::Matrix<double, 6, 6, Eigen::RowMajor> C;
      covariance.GetCovarianceBlockInTangentSpace(pose, pose, C.data());
      Eigen::Matrix<double, 3, 6> J;
      J << -PoseOf<double>(rgbd_pose::PoseBlock::Read(pose)).R() *
               rgbd_pose::CrossMatrix(kPrism),
          Matrix3d::Identity();
      J = positions_[k].sqrt_information * J;
      trace += (J * C * J.transpose()).trace();
    }
    trace *= static_cast<double>(measured.size()) / sampled;
    const double parameters = 15.0 * states_.size() + 1.0;
    factors_freedom_ = 15.0 * factors.size() - (parameters - trace);
    positions_freedom_ = 3.0 * measured.size() - trace;
  }

  const rgbd_pose::ImuBuffer* imu_;
  std::vector<Position> positions_;
  std::vector<State> states_;
  double delay_ = 0.0;  // of the inertial sensor's clock, s
  double cost_ = 0.0;
  double factors_chi2_ = 0.0, factors_freedom_ = 0.0;
  double positions_chi2_ = 0.0, positions_freedom_ = 0.0;
  BiasMatrix first_covariance_, last_covariance_;
};

int Run(const std::string& folder) {
  rgbd_pose::ImuBuffer imu;
  for (const std::vector<double>& row : Rows(folder + "/imu0.csv", 7)) {
    imu.Add({row[0], {row[1], row[2], row[3]}, {row[4], row[5], row[6]}});
  }
  const std::vector<Position> all = ReadPositions(folder + "/leica0.csv");
  // Both sensors measured in the meantime, by any clock of the two.
  constexpr double kMargin = 0.5;
  std::vector<Position> halves[2];
  const double from = imu.samples().front().stamp + kMargin;
  const double to = imu.samples().back().stamp - kMargin;
  for (const Position& position : all) {
    if (position.stamp < from || position.stamp > to) continue;
    halves[position.stamp > 0.5 * (from + to)].push_back(position);
  }
  Path first(imu, halves[0]), second(imu, halves[1]);
  for (Path* path : {&first, &second}) {
    path->Solve();
    path->Print();
  }
  std::printf("bias_distance %.1f\n", first.BiasDistance(second));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: inertial_path FOLDER\n");
    return 2;
  }
  try {
    return Run(argv[1]);
  } catch (const rgbd_pose::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
