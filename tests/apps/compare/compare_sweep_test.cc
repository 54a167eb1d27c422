#include "apps/compare/compare_sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::Not;

MedianBand Around(double median) {
  return {median, 0.9 * median, 1.1 * median, 2.0 * median};
}

// All methods with the given losses, each with errors of 1 mm and 0.1 degrees.
std::vector<SweepCell> LevelCells(const std::vector<std::string>& losses) {
  std::vector<SweepCell> cells;
  for (const std::string& loss : losses) {
    for (const char* schedule : {"gnc", "direct"}) {
      for (const bool ransac : {false, true}) {
        for (int i = 0; i < kSweepShares; ++i) {
          cells.push_back({{loss, schedule, ransac},
                           SweepShare(i),
                           Around(0.1),
                           Around(1.0)});
        }
      }
    }
  }
  return cells;
}

void SetError(const SweepMethod& method, int share, double median,
              std::vector<SweepCell>* cells) {
  for (SweepCell& cell : *cells) {
    if (cell.method == method && cell.outlier_share == SweepShare(share)) {
      cell.translation_mm = Around(median);
    }
  }
}

TEST(SweepVerdictTest, RansacThatChangesNothing) {
  const std::string verdict = SweepVerdict(LevelCells({"none", "tukey"}));
  EXPECT_THAT(verdict, HasSubstr("Under the gnc schedule a start from RANSAC "
                                 "changes no median beyond the bands, at any "
                                 "share."));
  EXPECT_THAT(verdict,
              HasSubstr("direct schedule a start from RANSAC changes"));
  EXPECT_THAT(verdict, HasSubstr("bands of the medians overlap): tukey."));
}

// The verdict names only shares at which RANSAC matters, in either direction.
TEST(SweepVerdictTest, RansacThatHelpsAtSomeShares) {
  std::vector<SweepCell> cells = LevelCells({"none", "tukey", "welsch"});
  SetError({"tukey", "direct", false}, 1, 90.0, &cells);
  SetError({"tukey", "direct", false}, 4, 70.0, &cells);
  SetError({"welsch", "direct", true}, 5, 3.0, &cells);
  for (int i = 0; i < kSweepShares; ++i) {
    SetError({"none", "gnc", false}, i, 8.0, &cells);
  }
  const std::string verdict = SweepVerdict(cells);
  EXPECT_THAT(verdict,
              HasSubstr("gnc schedule a start from RANSAC lowers the median "
                        "beyond the bands for none (at every share; 1 mm "
                        "instead of 8 mm at 60 %)."));
  EXPECT_THAT(verdict,
              HasSubstr("lowers the median beyond the bands for tukey (at 10, "
                        "40 % wrong matches; 1 mm instead of 70 mm at 40 %) "
                        "and raises the median beyond the bands for welsch (3 "
                        "mm instead of 1 mm at 50 %)."));
  EXPECT_THAT(verdict,
              HasSubstr("The error of none is 8 times as large at 0 %, "
                        "8 times at 30 % and 8 times at 60 %."));
}

// welsch is first worse than the best, with bands that meet, and then better at
// one share, with bands that do not meet.
TEST(SweepVerdictTest, LevelMeansThatBandsMeetFromEitherSide) {
  std::vector<SweepCell> cells = LevelCells({"tukey", "welsch"});
  for (int i = 0; i < kSweepShares; ++i) {
    SetError({"welsch", "gnc", false}, i, 1.1, &cells);
  }
  EXPECT_THAT(SweepVerdict(cells), HasSubstr("overlap): welsch."));
  SetError({"welsch", "gnc", false}, 2, 0.6, &cells);
  const std::string verdict = SweepVerdict(cells);
  EXPECT_THAT(verdict, HasSubstr("tukey has the smallest"));
  EXPECT_THAT(verdict,
              HasSubstr("No other loss is equally good at every share."));
}

TEST(SweepVerdictTest, OneLossHasNoRivals) {
  const std::string verdict = SweepVerdict(LevelCells({"tukey"}));
  EXPECT_THAT(verdict, Not(HasSubstr("other loss")));
  EXPECT_THAT(verdict, Not(HasSubstr("Equally good")));
}

TEST(SweepCsvTest, IsReadAsItWasWritten) {
  const TempFolder folder;
  std::vector<SweepCell> cells = LevelCells({"none", "tukey"});
  SetError({"tukey", "direct", true}, 3, 0.25, &cells);
  const std::string csv = SweepCsv(cells);
  const std::vector<SweepCell> read =
      ReadSweepCsv(folder.Write("sweep.csv", csv));
  ASSERT_EQ(read.size(), cells.size());
  EXPECT_EQ(SweepCsv(read), csv);
  EXPECT_EQ(SweepVerdict(read), SweepVerdict(cells));
}

TEST(SweepCsvTest, AnIncompleteFileIsRefused) {
  const TempFolder folder;
  std::vector<SweepCell> cells = LevelCells({"none"});
  cells.pop_back();
  const std::string file = folder.Write("sweep.csv", SweepCsv(cells));
  ExpectInputError([&] { ReadSweepCsv(file); },
                   {file, "missing shares of none, direct, from RANSAC"});
  folder.Write("sweep.csv", SweepCsv({}));
  ExpectInputError([&] { ReadSweepCsv(file); }, {file, "no rows"});
}

TEST(CompareStatisticsTest, RanksAreThoseOfTables) {
  // As in the tables of David & Nagaraja: the 40th and 61st of 100 values, the
  // 2nd and 9th of 10, the extremes of 6. Ranks count from 0.
  EXPECT_EQ(MedianBandRank(100), 39);
  EXPECT_EQ(MedianBandRank(10), 1);
  EXPECT_EQ(MedianBandRank(6), 0);
  EXPECT_EQ(MedianBandRank(1), 0);
}

TEST(CompareStatisticsTest, BandOfKnownValues) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const MedianBand band = FindMedianBand(values);
  EXPECT_EQ(band.median, 50.5);
  EXPECT_EQ(band.low, 40.0);
  EXPECT_EQ(band.high, 61.0);
  EXPECT_EQ(band.p90, 90.0);
  EXPECT_TRUE(std::isnan(FindMedianBand({}).median));
}

TEST(CompareStatisticsTest, BandHoldsTheMedianAsOftenAsItSays) {
  std::mt19937 generator(1);
  const int trials = 2000;
  int held = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> values;
    for (int i = 0; i < 50; ++i) values.push_back(generator() / 4294967296.0);
    const MedianBand band = FindMedianBand(values);
    held += band.low <= 0.5 && 0.5 <= band.high;
  }
  // Binomial distribution: 96.7 %; 2000 trials have a sigma of 0.4 %.
  EXPECT_NEAR(held / static_cast<double>(trials), 0.967, 0.016);
}

}  // namespace
}  // namespace rgbd_pose
