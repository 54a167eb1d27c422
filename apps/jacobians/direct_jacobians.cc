#include "apps/jacobians/direct_jacobians.h"

#include <ceres/crs_matrix.h>
#include <ceres/problem.h>

#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "core/estimation/frame_view.h"
#include "core/estimation/motion_cost.h"
#include "core/geometry/depth_noise.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/util/named_values.h"
#include "costs/direct_cost_factory.h"
#include "frontend/frame/image_pyramid.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

// A rendered frame as direct costs see it.
struct RenderedFrame {
  RenderedFrame(const SyntheticDataset& dataset, int index)
      : frame(dataset.Read(index)),
        pyramid(SmoothPyramid(PreparedFrame(frame)).levels),
        view(ViewFrame(frame, pyramid, dataset.camera().camera,
                       *FindNamed(DepthNoiseModels(), "khoshelham"))) {}

  Frame frame;
  std::vector<cv::Mat> pyramid;
  FrameView view;
};

// Of a cost's residuals at the motion x[6] relative to `origin`.
Jacobian JacobianAt(Assembly assembly, const LinearizationPoint& origin,
                    MotionVector x, MotionCost* cost) {
  ceres::Problem problem;
  problem.AddParameterBlock(x.data(), 6);
  cost->AddTo(assembly, origin, nullptr, x.data(), &problem);
  ceres::CRSMatrix crs;
  problem.Evaluate({}, nullptr, nullptr, nullptr, &crs);
  return Eigen::Map<const Jacobian>(crs.values.data(), crs.num_rows, 6);
}

}  // namespace

JacobianInThreeWays JacobiansOfPixels(const std::string& cost_name,
                                      int max_pixels, uint32_t seed,
                                      double step) {
  constexpr int kPrev = 10, kCur = 12;
  SyntheticOptions room;
  room.path = "handheld";
  room.seed = seed;
  const SyntheticDataset dataset(room);
  const RenderedFrame prev(dataset, kPrev), cur(dataset, kCur);
  FramePair pair;
  pair.prev = &prev.view;
  pair.cur = &cur.view;
  const Rigid3d cur_from_prev =
      dataset.WorldFromCam(kCur).Inverse() * dataset.WorldFromCam(kPrev);

  DirectOptions options;
  options.max_points = max_pixels;
  const std::unique_ptr<MotionCost> cost = MakeDirectCost(cost_name, options);
  cost->Bind(pair);
  cost->Associate(cur_from_prev);
  const LinearizationPoint origin(cur_from_prev);
  RandomWorld random(seed);
  MotionVector x;
  x << random.Vector(0.02), random.Vector(0.03);

  JacobianInThreeWays result;
  result.by_hand = JacobianAt(Assembly::kPerMatch, origin, x, cost.get());
  result.by_autodiff = JacobianAt(Assembly::kAutodiff, origin, x, cost.get());
  result.by_differences.resize(result.by_hand.rows(), 6);
  const auto residuals_at = [&](MotionVector moved) {
    std::vector<double> r;
    cost->Residuals(origin.DerivativesAt(moved.data()), &r);
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
        r.data(), static_cast<Eigen::Index>(r.size())));
  };
  for (int k = 0; k < 6; ++k) {
    const MotionVector d = step * MotionVector::Unit(k);
    result.by_differences.col(k) =
        (residuals_at(x + d) - residuals_at(x - d)) / (2.0 * step);
  }
  return result;
}

}  // namespace rgbd_pose
