// Every lens is tracked as accurately as a pinhole, with rolling shutters as
// well.

#include <gtest/gtest.h>

#include <vector>

#include "frontend/tracking/odometry.h"
#include "tests/support/rendered_once.h"
#include "tests/support/tracker_parts.h"

namespace rgbd_pose {
namespace {

struct TrackedLens {
  const char* name;
  LensModel model;
  std::vector<double> coefficients;
  double focal;  // px, for 320 x 240
};

class LensTrackingTest : public testing::TestWithParam<TrackedLens> {};

TEST_P(LensTrackingTest, IsTrackedToMillimetres) {
  for (const bool is_rolling : {false, true}) {
    SyntheticOptions options;
    options.path = "handheld";
    options.frames = 25;
    const double focal = GetParam().focal;
    options.camera.camera = {320, 240, focal, focal, 159.5, 119.5};
    ASSERT_TRUE(options.camera.camera.SetDistortion(GetParam().model,
                                                    GetParam().coefficients));
    if (is_rolling) {
      options.color_shutter = {0.0, 0.025};
      options.depth_shutter = {-0.01, 0.025};
    }
    const RenderedOnce room(options);  // for all trackers
    for (const char* const tracker : {"features", "direct", "hybrid"}) {
      Odometry odometry({},
                        MakeTracker(tracker, PartsFor(room.camera().camera)));
      double largest = 0.0;
      for (int i = 0; i < options.frames; ++i) {
        const TrackedFrame tracked = odometry.Track(room.Read(i));
        ASSERT_EQ(tracked.status, TrackingStatus::kOk)
            << tracker << i << tracked.reason;
        const Rigid3d truth =
            room.WorldFromCam(0).Inverse() * room.WorldFromCam(i);
        largest = std::max(
            largest,
            (tracked.world_from_cam.Inverse() * truth).translation.norm());
      }
      // Pinholes of these focal lengths: 1 to 2 mm, and 2 to 5 mm.
      EXPECT_LT(largest, is_rolling ? 8e-3 : 4e-3) << tracker << is_rolling;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, LensTrackingTest,
                         testing::Values(TrackedLens{"Rational",
                                                     LensModel::kRational,
                                                     {0.47, -2.5, 9e-4, -3e-4,
                                                      1.48, 0.35, -2.33, 1.41},
                                                     240.0},
                                         TrackedLens{
                                             "Fisheye",
                                             LensModel::kEquidistant,
                                             {-0.008, 0.045, -0.042, 0.008},
                                             160.0}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace rgbd_pose
