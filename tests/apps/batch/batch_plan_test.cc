#include "apps/batch/batch_plan.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

// The folders do not exist; their inputs have a hash nevertheless.
const std::vector<BatchSequence> kSequences = {
    {"one", "/none/one", "tum_fr1"},
    {"two", "/none/two", "tum_fr1"},
    {"three", "/none/three", "tum_fr2"}};

TEST(BatchPlanTest, HasAllCombinationsInOrder) {
  const BatchGrid grid = ParseGrid(
      {"epipolar,reprojection_depth+epipolar", "huber, tukey", "klt"}, 2);
  const std::vector<BatchRun> plan = MakePlan(kSequences, grid, {}, "");
  ASSERT_EQ(plan.size(), 3u * 2 * 2 * 1 * 2);
  EXPECT_EQ(plan[0].Name(), "one/epipolar-huber-klt-r1");
  EXPECT_EQ(plan[1].Name(), "one/epipolar-huber-klt-r2");
  EXPECT_EQ(plan[2].Name(), "one/epipolar-tukey-klt-r1");
  EXPECT_EQ(plan[4].Name(), "one/reprojection_depth+epipolar-huber-klt-r1");
  EXPECT_EQ(plan[8].Name(), "two/epipolar-huber-klt-r1");
  std::set<std::string> names;
  for (const BatchRun& run : plan) names.insert(run.Name());
  EXPECT_EQ(names.size(), plan.size());
}

TEST(BatchPlanTest, LossesMayHaveWidths) {
  const BatchGrid grid = ParseGrid({"epipolar", "huber(1),huber(2)", "klt"}, 1);
  const auto plan = MakePlan({kSequences[0]}, grid, {}, "");
  ASSERT_EQ(plan.size(), 2u);
  EXPECT_EQ(plan[0].Name(), "one/epipolar-huber(1)-klt-r1");
  EXPECT_NE(plan[0].hash, plan[1].hash);
}

TEST(BatchPlanTest, TrackersAndPartsAreVariedToo) {
  const BatchGrid grid =
      ParseGrid({"epipolar", "huber", "klt", "features,hybrid", "0-,3-"}, 1);
  const auto plan = MakePlan({kSequences[0]}, grid, {}, "");
  ASSERT_EQ(plan.size(), 4u);
  EXPECT_EQ(plan[1].Name(), "one/epipolar-huber-klt-features-3-r1");
  EXPECT_EQ(plan[2].Name(), "one/epipolar-huber-klt-hybrid-0-r1");
  EXPECT_NE(plan[0].hash, plan[1].hash);
  const BatchGrid whole =
      ParseGrid({"epipolar", "huber", "klt", "hybrid", ""}, 1);
  EXPECT_EQ(MakePlan({kSequences[0]}, whole, {}, "")[0].Name(),
            "one/epipolar-huber-klt-hybrid-r1");
  ExpectInputError(
      [] {
        ParseGrid({"epipolar", "huber", "klt", "hybrid", "3"}, 1);
      },
      {"--parts", "'3'"});
}

TEST(BatchPlanTest, AShardHasWholeSequences) {
  const BatchGrid grid = ParseGrid({"epipolar", "huber,tukey", "klt"}, 1);
  const std::vector<BatchRun> plan = MakePlan(kSequences, grid, {0, 2}, "");
  ASSERT_EQ(plan.size(), 4u);
  EXPECT_EQ(plan[1].sequence.name, "one");
  EXPECT_EQ(plan[2].sequence.name, "three");
  EXPECT_TRUE(MakePlan(kSequences, grid, {4, 5}, "").empty());
}

TEST(BatchPlanTest, TheHashDependsOnAllButRepeats) {
  const BatchGrid grid = ParseGrid({"epipolar", "huber,tukey", "klt,orb"}, 2);
  const auto plan = MakePlan(kSequences, grid, {}, "");
  const auto again = MakePlan(kSequences, grid, {}, "");
  const auto other = MakePlan(kSequences, grid, {}, "--scale=mad");
  std::set<std::string> hashes;
  for (size_t i = 0; i < plan.size(); ++i) {
    hashes.insert(plan[i].hash);
    EXPECT_EQ(plan[i].hash, again[i].hash);
    EXPECT_NE(plan[i].hash, other[i].hash);
  }
  // Sequences one and two have the same inputs: no files and the same camera.
  EXPECT_EQ(hashes.size(), 2u * 2 * 2);
}

TEST(BatchPlanTest, RefusesNamesThatAreNotThere) {
  const struct {
    std::vector<std::string> lists;  // costs, losses and frontends
    int repeats;
    std::vector<std::string> message_parts;
  } kCases[] = {
      {{"magic", "huber", "klt"},
       1,
       {"--costs", "'magic'", "bidirectional_point"}},
      {{"epipolar+magic", "huber", "klt"}, 1, {"--costs", "'magic'"}},
      {{"epipolar", "huber,", "klt"}, 1, {"--losses", "''"}},
      {{"epipolar", "huber", "magic"}, 1, {"--frontends: unknown"}},
      {{"epipolar", "huber", "klt,klt"}, 1, {"--frontends", "'klt'", "twice"}},
      {{"epipolar", "huber", "klt"}, 0, {"--repeats"}}};
  for (const auto& c : kCases) {
    ExpectInputError([&] { ParseGrid(c.lists, c.repeats); }, c.message_parts);
  }
}

// Sets Slurm's variables for the tasks of a job array; null unsets one.
void SetArray(const char* id, const char* count, const char* first) {
  const struct {
    const char* name;
    const char* value;
  } kVariables[] = {{"SLURM_ARRAY_TASK_ID", id},
                    {"SLURM_ARRAY_TASK_COUNT", count},
                    {"SLURM_ARRAY_TASK_MIN", first}};
  for (const auto& variable : kVariables) {
    if (variable.value == nullptr) {
      unsetenv(variable.name);
    } else {
      setenv(variable.name, variable.value, 1);
    }
  }
}

class BatchShardTest : public testing::Test {
 protected:
  BatchShardTest() { SetArray(nullptr, nullptr, nullptr); }
  ~BatchShardTest() override { SetArray(nullptr, nullptr, nullptr); }
};

TEST_F(BatchShardTest, IsTheWholeWithoutAWord) {
  const BatchShard shard = ParseShard("");
  EXPECT_TRUE(shard.IsWhole());
  EXPECT_TRUE(shard.Has(0));
  EXPECT_TRUE(shard.Has(7));
}

TEST_F(BatchShardTest, ShardsShareOutAllSequences) {
  for (int sequence = 0; sequence < 10; ++sequence) {
    int owners = 0;
    for (const std::string text : {"0/3", "1/3", "2/3"}) {
      owners += ParseShard(text).Has(sequence);
    }
    EXPECT_EQ(owners, 1) << sequence;
  }
  EXPECT_EQ(ParseShard("2/3").Name(), "2-of-3");
}

TEST_F(BatchShardTest, ReadsTheSlurmArray) {
  SetArray("5", "4", "3");
  EXPECT_EQ(ParseShard("").Name(), "2-of-4");
  SetArray("0", "2", nullptr);
  EXPECT_EQ(ParseShard("").Name(), "0-of-2");
  EXPECT_EQ(ParseShard("1/5").Name(), "1-of-5") << "the flag comes first";
  SetArray("7", "2", "3");  // --array=3,7
  ExpectInputError([] { ParseShard(""); }, {"task 7", "--shard"});
}

TEST_F(BatchShardTest, RefusesOtherTexts) {
  for (const std::string text :
       {"1", "/", "1/", "/2", "2/2", "-1/2", "0/0", "0/2x", "a/b", "0/1/2"}) {
    ExpectInputError([&] { ParseShard(text); }, {"--shard=" + text});
  }
}

}  // namespace
}  // namespace rgbd_pose
