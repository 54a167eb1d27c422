// Values of flags that have a syntax of their own.

#include "apps/batch/batch_plan.h"
#include "costs/cost_factory.h"
#include "frontend/sources/frame_range.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(flag_values) {
  using namespace rgbd_pose;
  const std::string text(FuzzText(data, size));
  MayRefuse([&] {
    const BatchShard shard = ParseShard(text);
    Require(0 <= shard.index && shard.index < shard.count, "a shard");
  });
  MayRefuse([&] {
    const FrameSelection selection("flag", text);
    for (const int index : {0, 1, 20, 2147483647}) selection.Contains(index);
  });
  MayRefuse([&] {
    Require(!ParseGrid({text, "tukey", "klt"}, 1).combinations.empty(),
            "a cost");
  });
  MayRefuse([&] { Require(!MakeRobustCosts(text, "none").empty(), "a cost"); });
  MayRefuse([&] { MakeRobustCosts("bidirectional_point+epipolar", text); });
  return 0;
}
