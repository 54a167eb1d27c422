// A cost that does not use matches: gray levels of a textured wall, with pixels
// selected at every step, coarse to fine, and with a scale of their own.

#include "core/estimation/motion_cost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "core/estimation/estimator.h"
#include "costs/assembly/cost_blocks.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/scale.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

constexpr int kWidth = 160, kHeight = 120, kLevels = 4;
constexpr double kGrayNoise = 1.5;  // gray levels
constexpr double kGraySigma = 2.0;  // of a difference, with interpolation

Rigid3d Truth() {
  return Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(
                     0.03, Eigen::Vector3d(1.0, -1.0, 2.0).normalized())),
                 Eigen::Vector3d(0.08, -0.05, 0.04));
}

Camera WallCamera() {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 120.0;
  camera.cx = 0.5 * kWidth;
  camera.cy = 0.5 * kHeight;
  return camera;
}

// A tilted wall n . X = 2 m in previous axes. Long waves of its texture guide
// the solver from far away; short waves would mislead it there.
struct Wall {
  const Eigen::Vector3d n = Eigen::Vector3d(-0.2, 0.3, 1.0);

  static double Gray(const Eigen::Vector3d& X) {
    return 128.0 + 20.0 * std::sin(5.0 * X.x() + 1.0) +
           20.0 * std::sin(6.0 * X.y() - 2.0 * X.x()) +
           15.0 * std::sin(50.0 * X.x()) * std::sin(50.0 * X.y());
  }

  // The point, in previous axes, where the ray of a pixel meets the wall.
  Eigen::Vector3d Hit(const Camera& camera, const Rigid3d& prev_from_cam,
                      double u, double v) const {
    const Eigen::Vector3d d = prev_from_cam.rotation *
                              Eigen::Vector3d((u - camera.cx) / camera.fx,
                                              (v - camera.cy) / camera.fy, 1.0);
    const Eigen::Vector3d& C = prev_from_cam.translation;
    return C + (2.0 - n.dot(C)) / n.dot(d) * d;
  }
};

// Images of the wall and their view.
struct WallFrame {
  std::vector<uint8_t> gray[kLevels];
  std::vector<uint16_t> depth;
  FrameView view;

  WallFrame(const Rigid3d& cam_from_prev, unsigned seed) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> noise(0.0, kGrayNoise);
    const Rigid3d prev_from_cam = cam_from_prev.Inverse();
    Camera camera = WallCamera();
    const Wall wall;
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const Eigen::Vector3d X = wall.Hit(camera, prev_from_cam, u, v);
        const double value = Wall::Gray(X) + noise(generator);
        gray[0].push_back(static_cast<uint8_t>(std::lround(value)));
        const double z = (cam_from_prev * X).z();
        depth.push_back(static_cast<uint16_t>(std::lround(5000.0 * z)));
      }
    }
    view.depth = {depth.data(), kWidth, kHeight, kWidth};
    for (int level = 0; level < kLevels; ++level) {
      const int width = kWidth >> level, height = kHeight >> level;
      if (level > 0) Halve(gray[level - 1], width, height, &gray[level]);
      view.levels.push_back(
          {{gray[level].data(), width, height, width}, camera});
      camera.fx *= 0.5;
      camera.fy *= 0.5;
      camera.cx = 0.5 * (camera.cx + 0.5) - 0.5;
      camera.cy = 0.5 * (camera.cy + 0.5) - 0.5;
    }
  }

  static void Halve(const std::vector<uint8_t>& fine, int width, int height,
                    std::vector<uint8_t>* coarse) {
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        const uint8_t* at = &fine[4 * v * width + 2 * u];
        const int sum = at[0] + at[1] + at[2 * width] + at[2 * width + 1];
        coarse->push_back(static_cast<uint8_t>((sum + 2) / 4));
      }
    }
  }
};

// r = (I_cur(project(R (X - C))) - I_prev) / sigma for pixels of the previous
// image that are visible in the current one.
class GrayCost final : public MotionCost {
 public:
  explicit GrayCost(double sigma, int group = 1, double information = 1.0)
      : sigma_(sigma), group_(group), information_(information) {}

  std::string_view name() const override { return "gray"; }
  int num_residuals() const override { return 1; }
  int degrees_of_freedom() const override { return 1; }
  bool is_whitened() const override { return true; }
  int scale_group() const override { return group_; }
  double information_factor() const override { return information_; }
  AssociationPolicy association() const override {
    return AssociationPolicy::kEveryStep;
  }
  int num_levels() const override {
    return static_cast<int>(pair_.prev->levels.size());
  }
  void SetLevel(int level) override { level_ = level; }
  void Bind(const FramePair& pair) override {
    pair_ = pair;
    level_ = 0;
  }

  void Associate(const Rigid3d& cur_from_prev) override {
    ++*num_associations;
    const FrameView::Level& prev = pair_.prev->levels[level_];
    const Camera& camera = prev.camera;
    pixels_.clear();
    for (int v = 0; v < prev.gray.height; ++v) {
      for (int u = 0; u < prev.gray.width; ++u) {
        // The depth at the full-resolution pixel in the middle of this pixel.
        const double half = 0.5 * (1 << level_) - 0.5;
        const double z =
            pair_.prev->DepthAt(static_cast<int>((u << level_) + half),
                                static_cast<int>((v << level_) + half));
        const Eigen::Vector3d X((u - camera.cx) / camera.fx * z,
                                (v - camera.cy) / camera.fy * z, z);
        const Eigen::Vector3d q = cur_from_prev * X;
        const double cur_u = camera.fx * q.x() / q.z() + camera.cx;
        const double cur_v = camera.fy * q.y() / q.z() + camera.cy;
        if (cur_u < 1.0 || cur_u > prev.gray.width - 2.0 || cur_v < 1.0 ||
            cur_v > prev.gray.height - 2.0) {
          continue;
        }
        pixels_.push_back({X, static_cast<double>(prev.gray.At(u, v))});
      }
    }
    matches_.assign(pixels_.size(), -1);
    degrees_.assign(pixels_.size(), 1);
  }

  const std::vector<int>& matches() const override { return matches_; }
  const std::vector<int>& degrees() const override { return degrees_; }

  void Residuals(const MotionDerivatives& motion,
                 std::vector<double>* residuals) const override {
    residuals->clear();
    MotionVector J;
    for (const Pixel& pixel : pixels_) {
      residuals->push_back(Residual(motion, pixel, &J));
    }
  }

  void SquaredNorms(const MotionDerivatives& motion,
                    std::vector<double>* norms) const override {
    Residuals(motion, norms);
    for (double& value : *norms) value *= value;
  }

  void Linearise(const MotionDerivatives& motion,
                 const ceres::LossFunction* loss,
                 NormalEquations* sum) const override {
    for (const Pixel& pixel : pixels_) {
      MotionVector J;
      const double r = Residual(motion, pixel, &J);
      double rho[3] = {r * r, 1.0, 0.0};
      if (loss != nullptr) loss->Evaluate(r * r, rho);
      sum->cost += 0.5 * rho[0];
      sum->gradient += rho[1] * r * J;
      sum->hessian += rho[1] * J * J.transpose();
    }
  }

  void AddScoreOuterProduct(const MotionDerivatives&,
                            const ceres::LossFunction*,
                            MotionMatrix*) const override {}

  void AddTo(Assembly, const LinearizationPoint& origin,
             ceres::LossFunction* loss, double* x,
             ceres::Problem* problem) override {
    block_.emplace(MotionSums(this, &origin, loss));
    problem->AddResidualBlock(&*block_, nullptr, x);
  }

  // Outlives the cost, which is owned by an estimator.
  std::shared_ptr<int> num_associations = std::make_shared<int>(0);

 private:
  struct Pixel {
    Eigen::Vector3d X;
    double gray;
  };

  double Residual(const MotionDerivatives& motion, const Pixel& pixel,
                  MotionVector* J) const {
    const FrameView::Level& cur = pair_.cur->levels[level_];
    const Eigen::Vector3d d = pixel.X - motion.C;
    const Eigen::Vector3d q = motion.R * d;
    const double u = std::clamp(cur.camera.fx * q.x() / q.z() + cur.camera.cx,
                                0.0, cur.gray.width - 1.001);
    const double v = std::clamp(cur.camera.fy * q.y() / q.z() + cur.camera.cy,
                                0.0, cur.gray.height - 1.001);
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    const double a = u - column, b = v - row;
    const double g00 = cur.gray.At(column, row);
    const double g10 = cur.gray.At(column + 1, row);
    const double g01 = cur.gray.At(column, row + 1);
    const double g11 = cur.gray.At(column + 1, row + 1);
    const double by_u = (1.0 - b) * (g10 - g00) + b * (g11 - g01);
    const double by_v = (1.0 - a) * (g01 - g00) + a * (g11 - g10);
    const Eigen::RowVector3d by_q(
        by_u * cur.camera.fx / q.z(), by_v * cur.camera.fy / q.z(),
        -(by_u * cur.camera.fx * q.x() + by_v * cur.camera.fy * q.y()) /
            (q.z() * q.z()));
    for (int k = 0; k < 3; ++k) (*J)[k] = by_q.dot(motion.dR[k] * d) / sigma_;
    J->tail<3>() = -motion.R.transpose() * by_q.transpose() / sigma_;
    const double gray = (1.0 - b) * ((1.0 - a) * g00 + a * g10) +
                        b * ((1.0 - a) * g01 + a * g11);
    return (gray - pixel.gray) / sigma_;
  }

  const double sigma_;
  const int group_;
  const double information_;
  FramePair pair_;
  int level_ = 0;
  std::vector<Pixel> pixels_;
  std::vector<int> matches_, degrees_;
  std::optional<MotionBlock> block_;
};

class MotionCostTest : public ::testing::Test {
 protected:
  MotionCostTest() : prev_(Rigid3d(), 1), cur_(Truth(), 2) {}

  MotionEstimate Estimate(std::vector<RobustCost> terms,
                          const EstimatorOptions& options,
                          const Correspondences* matches = nullptr) {
    MotionEstimate estimate;
    Estimator(options, std::move(terms))
        .Estimate({matches, nullptr, &prev_.view, &cur_.view}, Rigid3d(),
                  &estimate);
    return estimate;
  }

  MotionEstimate Estimate(std::unique_ptr<GrayCost> cost) {
    std::vector<RobustCost> terms;
    terms.push_back({std::move(cost), nullptr});
    return Estimate(std::move(terms), {});
  }

  WallFrame prev_, cur_;
};

TEST_F(MotionCostTest, LevelsFindWhatTheFinestAloneDoesNot) {
  const MotionEstimate estimate =
      Estimate(std::make_unique<GrayCost>(kGraySigma));
  EXPECT_TRUE(estimate.ok()) << estimate.reason;
  EXPECT_LE(ErrorOf(estimate.cur_from_prev, Truth()).translation, 2e-3);
  EXPECT_LE(ErrorOf(estimate.cur_from_prev, Truth()).angle, 1e-3);
  EXPECT_NEAR(estimate.sigma, 1.0, 0.2);
  EXPECT_GT(estimate.num_used, kWidth * kHeight / 2);
  EXPECT_GT(estimate.num_inliers, 0.9 * estimate.num_used);
  prev_.view.levels.resize(1);
  const MotionEstimate finest =
      Estimate(std::make_unique<GrayCost>(kGraySigma));
  EXPECT_GT(ErrorOf(finest.cur_from_prev, Truth()).translation, 0.02);
}

TEST_F(MotionCostTest, IsAssociatedAfterEveryStep) {
  auto cost = std::make_unique<GrayCost>(kGraySigma);
  const std::shared_ptr<int> count = cost->num_associations;
  const MotionEstimate estimate = Estimate(std::move(cost));
  EXPECT_GT(estimate.iterations, kLevels);
  EXPECT_GE(*count, estimate.iterations + kLevels);
}

// The noise of gray levels is four times the model's; that of matches is right.
TEST_F(MotionCostTest, EachGroupHasItsOwnScale) {
  const Correspondences matches = RandomWorld(3).Matches(60, 0.0, Truth());
  EstimatorOptions options;
  options.scale = MadScale;
  const auto estimate = [&](double sigma, int group) {
    std::vector<RobustCost> terms;
    terms.push_back({MakeCost("mahalanobis_point"), nullptr});
    terms.push_back({std::make_unique<GrayCost>(sigma, group), nullptr});
    return Estimate(std::move(terms), options, &matches);
  };
  const MotionEstimate right = estimate(kGraySigma, 1);
  const MotionEstimate apart = estimate(0.25 * kGraySigma, 1);
  const MotionEstimate together = estimate(0.25 * kGraySigma, 0);
  EXPECT_TRUE(apart.ok()) << apart.reason;
  const double off =
      ErrorOf(apart.cur_from_prev, right.cur_from_prev).translation;
  EXPECT_LE(off, 1e-5);
  EXPECT_GT(ErrorOf(together.cur_from_prev, right.cur_from_prev).translation,
            10.0 * off);
  for (int i = 0; i < 6; ++i) {
    const double ratio = apart.covariance(i, i) / right.covariance(i, i);
    EXPECT_NEAR(ratio, 1.0, 0.05) << i;
  }
}

TEST_F(MotionCostTest, InformationFactorDividesTheCovariance) {
  const MotionEstimate all = Estimate(std::make_unique<GrayCost>(kGraySigma));
  const MotionEstimate quarter =
      Estimate(std::make_unique<GrayCost>(kGraySigma, 1, 0.25));
  EXPECT_LE(ErrorOf(all.cur_from_prev, quarter.cur_from_prev).translation,
            1e-5);
  for (int i = 0; i < 6; ++i) {
    const double ratio = quarter.covariance(i, i) / all.covariance(i, i);
    EXPECT_NEAR(ratio, 4.0, 0.05) << i;
  }
}

}  // namespace
}  // namespace rgbd_pose
