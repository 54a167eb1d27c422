#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "apps/batch/batch_plan.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

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
