// Covariances of cameras with rolling shutters.

#include <gtest/gtest.h>

#include <string>

#include "core/evaluation/consistency.h"
#include "tests/support/shutter_sequence.h"

namespace rgbd_pose {
namespace {

constexpr int kFrames = 45;
constexpr int kMinEdges = 40;

// Errors of edges of ok frames compared with their covariances.
struct Honesty {
  double nees = 0.0;  // mean chi^2 (6 degrees of freedom)
  int wrong = 0;      // errors of more than five sigmas
  int edges = 0;
};

Honesty HonestyOf(const ShutterSequence& sequence, const std::string& tracker,
                  ShutterUse use) {
  Odometry odometry = OdometryFor(sequence, tracker, use);
  Honesty honesty;
  for (const Frame& frame : sequence.frames) {
    const TrackedFrame tracked = odometry.Track(frame);
    if (tracked.status != TrackingStatus::kOk) continue;
    for (const RelativePose& edge : tracked.edges) {
      const double chi_square =
          ChiSquare(edge, sequence.Motion(edge.ref, edge.cur), {});
      honesty.nees += chi_square;
      honesty.wrong += chi_square > kWrongChiSquare;
      ++honesty.edges;
    }
  }
  honesty.nees /= honesty.edges;
  return honesty;
}

// Only if the middle row is exposed at the stamp: otherwise the references'
// time is known only as well as their velocity.
TEST(ShutterCovarianceTest, CovariancesAreAsHonestAsWithout) {
  const auto nees_with = [](const Shutters& shutters) {
    const Honesty honesty = HonestyOf({"handheld", shutters, kFrames},
                                      "features", ShutterUse::kCamera);
    EXPECT_GE(honesty.edges, kMinEdges);
    return honesty.nees;
  };
  const double without = nees_with({});
  for (const double sign : {1.0, -1.0}) {
    const double with =
        nees_with({{0.0, sign * 0.028}, {-0.0105, sign * 0.028}});
    EXPECT_LT(with, 2.0 * without);
    EXPECT_GT(with, 1.0);
  }
}

// The covariance includes the error of unknown shutters: partly for a hand as
// fast as this one, fully for real ones (see odometry.cc).
TEST(ShutterCovarianceTest, ShuttersThatNobodyKnowsAreAllowedFor) {
  for (const std::string tracker : {"features", "hybrid"}) {
    const Honesty honesty =
        HonestyOf({"handheld", RollingShutters(1.0), kFrames}, tracker,
                  ShutterUse::kNone);
    EXPECT_GE(honesty.edges, kMinEdges);
    EXPECT_LE(honesty.wrong, honesty.edges / 4) << tracker;
    EXPECT_LT(honesty.nees, 6.0 * 4.0) << tracker;
  }
}

// A turn that begins or stops within a tenth of a second bends what the rows of
// its frames see. Frames tracked against one of these inherit its error.
TEST(ShutterCovarianceTest, SuddenTurnsAreAllowedFor) {
  const Honesty honesty = HonestyOf({"whip_pan", RollingShutters(1.0), 75},
                                    "hybrid", ShutterUse::kCamera);
  EXPECT_GE(honesty.edges, kMinEdges);
  EXPECT_LE(honesty.wrong, honesty.edges / 20);
  EXPECT_LT(honesty.nees, 10.0);
}

// Cameras with unspecified shutters are treated like ignored shutters.
TEST(ShutterCovarianceTest, OnlyWhoSaysSoHasAGlobalShutter) {
  const ShutterSequence sequence("handheld", {}, 4);
  Odometry said = OdometryFor(sequence, "features", ShutterUse::kCamera);
  Odometry unsaid = OdometryFor(sequence, "features", ShutterUse::kCamera);
  for (Frame frame : sequence.frames) {
    ASSERT_TRUE(frame.HasKnownTimes());
    const TrackedFrame sure = said.Track(frame);
    frame.color_shutter.is_known = false;
    const TrackedFrame unsure = unsaid.Track(frame);
    if (sure.edges.empty()) continue;
    EXPECT_GT(unsure.edges[0].covariance.trace(),
              10.0 * sure.edges[0].covariance.trace());
  }
}

}  // namespace
}  // namespace rgbd_pose
