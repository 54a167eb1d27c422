#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/feature_tracker.h"
#include "frontend/tracking/odometry.h"
#include "tests/support/rendered_once.h"

namespace rgbd_pose {

// Two views of the simulated room and a frontend whose matches between them are
// compared with the truth.
class MatchedViews {
 protected:
  // Half a second apart on path xyz: about 0.1 m and 20 px of flow.
  static constexpr int kPrev = 0;
  static constexpr int kCur = 15;

  explicit MatchedViews(const std::string& frontend) {
    FrontendOptions options;
    options.camera = dataset_.camera().camera;
    frontend_ = MakeFrontend(frontend, options);
    cur_from_prev_ =
        dataset_.WorldFromCam(kCur).Inverse() * dataset_.WorldFromCam(kPrev);
  }

  FeatureMatches MatchFrom(const Frame& prev, const Frame& cur,
                           const Rigid3d& guess) {
    return MatchFrom(*Detect(prev), cur, guess);
  }
  FeatureMatches MatchFrom(const FeatureSet& reference, const Frame& cur,
                           const Rigid3d& guess) {
    FeatureMatches found{Correspondences(dataset_.camera().camera), {}};
    frontend_->Match(reference, PreparedFrame(cur), guess, &found);
    return found;
  }
  std::unique_ptr<FeatureSet> Detect(const Frame& frame) {
    return frontend_->Detect(PreparedFrame(frame));
  }

  // Distance (px) of each match from the true position of its point, sorted.
  std::vector<double> Errors(const Correspondences& matches) const {
    std::vector<double> errors;
    for (size_t i = 0; i < matches.size(); ++i) {
      const Observation& cur = matches[i].cur;
      const Eigen::Vector2d expected = dataset_.camera().camera.Project(
          cur_from_prev_ * matches.Point(matches[i].prev));
      errors.push_back((expected - Eigen::Vector2d(cur.u, cur.v)).norm());
    }
    std::sort(errors.begin(), errors.end());
    return errors;
  }

  static void ExpectSame(const FeatureMatches& a, const FeatureMatches& b) {
    ASSERT_EQ(a.features, b.features);
    for (size_t i = 0; i < a.matches.size(); ++i) {
      EXPECT_EQ(a.matches[i].cur.u, b.matches[i].cur.u);
      EXPECT_EQ(a.matches[i].cur.v, b.matches[i].cur.v);
      EXPECT_EQ(a.matches[i].cur.sigma_px, b.matches[i].cur.sigma_px);
    }
  }

  // `wrong_px`: a match with a larger error counts as an outlier.
  void ExpectMostlyRight(const FeatureMatches& found, size_t min_matches,
                         double median_px, double wrong_px) const {
    ASSERT_GE(found.matches.size(), min_matches);
    EXPECT_EQ(found.features.size(), found.matches.size());
    const std::vector<double> errors = Errors(found.matches);
    EXPECT_LT(errors[errors.size() / 2], median_px);
    const auto wrong =
        errors.end() - std::lower_bound(errors.begin(), errors.end(), wrong_px);
    // An M-estimator tolerates several times as many.
    EXPECT_LE(wrong, 0.1 * static_cast<double>(errors.size()));
  }

  // Moves the frontend into an odometry. `max_error`: of the last position, m.
  void ExpectTracksAlongItsAxes(double max_error) {
    Odometry odometry(
        {}, std::make_unique<FeatureTracker>(std::move(frontend_),
                                             Estimator({}, MakeRobustCosts())));
    constexpr int kLast = 19;
    Rigid3d end;
    for (int i = 0; i <= kLast; ++i) {
      const TrackedFrame result = odometry.Track(dataset_.Read(i));
      EXPECT_EQ(result.status, TrackingStatus::kOk)
          << i << ": " << result.reason;
      end = result.world_from_cam;
    }
    const Rigid3d truth =
        dataset_.WorldFromCam(0).Inverse() * dataset_.WorldFromCam(kLast);
    ASSERT_GT(truth.translation.norm(), 0.05) << "the path is vacuous";
    EXPECT_LE((end.translation - truth.translation).norm(), max_error);
  }

  static const RenderedOnce& Room() {
    static const RenderedOnce room((SyntheticOptions()));
    return room;
  }

  const RenderedOnce& dataset_ = Room();
  const Frame prev_ = dataset_.Read(kPrev);
  const Frame cur_ = dataset_.Read(kCur);
  std::unique_ptr<Frontend> frontend_;
  Rigid3d cur_from_prev_;
};

}  // namespace rgbd_pose
