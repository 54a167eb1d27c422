// When direct costs select the points of a previous frame.

#include <gtest/gtest.h>

#include <map>
#include <memory>

#include "core/estimation/estimator.h"
#include "costs/direct/photometric.h"
#include "costs/direct_cost_factory.h"
#include "robust/m_estimator.h"
#include "tests/support/direct_columns.h"

namespace rgbd_pose {
namespace {

// How often the points of each level have been selected.
std::map<int, int>& Selections() {
  static std::map<int, int> selections;
  return selections;
}

struct Counted : Photometric {
  static void Points(const FrameView& frame, int level,
                     const DirectOptions& options, PackedColumns* points) {
    ++Selections()[level];
    TexturedPoints(frame, level, options, points);
  }
};

using Levels = std::map<int, int>;

class DirectSelectionTest : public ::testing::Test {
 protected:
  DirectSelectionTest() { Selections().clear(); }

  // Binds a previous frame and uses one level of the pyramid.
  void Use(uint64_t id, int level) {
    pair_.prev.view.id = id;
    cost_.Bind(pair_.data());
    cost_.SetLevel(level);
    cost_.Associate(pair_.cur_from_prev);
    EXPECT_GT(cost_.matches().size(), 50u);
  }

  DirectPair pair_{SyntheticDataset(SmallImages()), 10, 12};
  DirectCostOf<Counted> cost_{DirectOptions()};  // finest_level: 1
};

TEST_F(DirectSelectionTest, OnlyLevelsInUseAndOncePerId) {
  cost_.Bind(pair_.data());
  EXPECT_EQ(Selections(), Levels());
  Use(7, 0);
  EXPECT_EQ(Selections(), (Levels{{1, 1}}));
  Use(7, 0);
  EXPECT_EQ(Selections(), (Levels{{1, 1}}));
  Use(7, 2);
  EXPECT_EQ(Selections(), (Levels{{1, 1}, {3, 1}}));
  Use(7, 0);
  EXPECT_EQ(Selections(), (Levels{{1, 1}, {3, 1}}));
  Use(8, 0);
  EXPECT_EQ(Selections(), (Levels{{1, 2}, {3, 1}}));
  Use(8, 2);
  EXPECT_EQ(Selections(), (Levels{{1, 2}, {3, 2}}));
}

TEST_F(DirectSelectionTest, FramesThatAreUsedInTurnAreKept) {
  constexpr int kInTurn = 20;  // as many as the odometry has keyframes
  for (int round = 0; round < 3; ++round) {
    for (uint64_t id = 1; id <= kInTurn; ++id) Use(id, 0);
    EXPECT_EQ(Selections(), (Levels{{1, kInTurn}}));
  }
  cost_.Bind(FramePair());
  Use(1, 0);
  EXPECT_EQ(Selections(), (Levels{{1, kInTurn}}));
  // One that was not used for long is selected again, the latest are kept.
  constexpr int kMany = 100;
  for (uint64_t id = 101; id <= 100 + kMany; ++id) Use(id, 0);
  EXPECT_EQ(Selections(), (Levels{{1, kInTurn + kMany}}));
  Use(100 + kMany - 1, 0);
  EXPECT_EQ(Selections(), (Levels{{1, kInTurn + kMany}}));
  Use(1, 0);
  EXPECT_EQ(Selections(), (Levels{{1, kInTurn + kMany + 1}}));
}

TEST_F(DirectSelectionTest, WithoutAnIdOncePerBoundPair) {
  Use(0, 0);
  Use(0, 0);
  EXPECT_EQ(Selections(), (Levels{{1, 2}}));
  cost_.Associate(pair_.cur_from_prev);
  EXPECT_EQ(Selections(), (Levels{{1, 2}}));
}

TEST_F(DirectSelectionTest, AnEstimatorThatStaysAtTheFinestLevelNeedsNoOther) {
  for (const int num_levels : {0, 1}) {
    Selections().clear();
    FramePair pair = pair_.data();
    pair.num_levels = num_levels;
    MotionEstimate estimate;
    Estimator(DirectEstimatorOptions(),
              std::make_unique<DirectCostOf<Counted>>(DirectOptions()),
              ParseLoss("huber").Make(1))
        .Estimate(pair, pair_.cur_from_prev, &estimate);
    EXPECT_TRUE(estimate.ok()) << estimate.reason;
    const Levels all = {{1, 1}, {2, 1}, {3, 1}, {4, 1}};
    EXPECT_EQ(Selections(), num_levels == 1 ? Levels({{1, 1}}) : all);
  }
}

}  // namespace
}  // namespace rgbd_pose
