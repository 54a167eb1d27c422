#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "apps/report/report_data.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

using nlohmann::json;

constexpr char kTablesHeader[] =
    "sequence,loss,alpha_deg,beta_deg,gamma_deg,cx_mm,cy_mm,cz_mm,end_deg,"
    "end_mm,ate_mm,rpe_seconds_mm,rpe_seconds_deg,tracked_share\n";
constexpr char kPathsHeader[] =
    "sequence,loss,timestamp,x,y,z,qx,qy,qz,qw,distance_m,angle_deg,"
    "rpe_seconds_m,rpe_seconds_deg\n";

// A sequence with its truth and one loss, which loses all frames but the last.
void WriteComparison(const TempFolder& folder, int frames) {
  folder.Write("config.flags", "# Experiment\n--experiment=xyz\n");
  folder.Write("tables.csv", std::string(kTablesHeader) +
                                 "\"a, b\",tukey,1,2,3,4,5,6,,8,9.5,,,0.5\n");
  std::string truth, tukey;
  for (int i = 0; i < frames; ++i) {
    const std::string time = std::to_string(100.0 + i / 32.0);
    // Rotated by 180 degrees about x: the camera's y axis points along -y.
    truth += "\"a, b\",truth," + time + "," + std::to_string(i) +
             ",0,0,1,0,0,0,,,,\n";
    tukey += "\"a, b\",tukey," + time +
             (i + 1 < frames ? ",,,,,,,,,,,\n" : ",7,0,0,1,0,0,0,0.25,1.5,,\n");
  }
  folder.Write("paths.csv", kPathsHeader + truth + tukey);
}

TEST(CompareReportDataTest, PathsAreColumnsWithGaps) {
  const TempFolder folder;
  WriteComparison(folder, 3);
  const json data = CompareReportData(folder.path());
  ASSERT_EQ(data.at("sequences").size(), 1u);
  const json& sequence = data.at("sequences")[0];
  EXPECT_EQ(sequence.at("name"), "a, b");
  EXPECT_EQ(sequence.at("num_frames"), 3);
  EXPECT_EQ(sequence.at("t")[2], 0.0625);
  EXPECT_EQ(sequence.at("down")[1], -1.0);
  EXPECT_EQ(sequence.at("truth").at("x").dump(), "[0.0,1.0,2.0]");
  ASSERT_EQ(sequence.at("losses").size(), 1u);
  const json& loss = sequence.at("losses")[0];
  EXPECT_EQ(loss.at("name"), "tukey");
  EXPECT_EQ(loss.at("x").dump(), "[null,null,7.0]");
  EXPECT_EQ(loss.at("distance_m").dump(), "[null,null,0.25]");
  EXPECT_EQ(loss.at("figures").at("ate_mm"), 9.5);
  EXPECT_EQ(loss.at("figures").at("end_deg").dump(), "null");
}

TEST(CompareReportDataTest, LongPathsAreThinnedTogether) {
  const TempFolder folder;
  WriteComparison(folder, kMaxComparedPoints);  // the truth has as many poses
  const json data = CompareReportData(folder.path());
  const json& sequence = data.at("sequences")[0];
  EXPECT_EQ(sequence.at("every"), 2);
  EXPECT_EQ(sequence.at("t").size(), kMaxComparedPoints / 2u);
  EXPECT_EQ(sequence.at("losses")[0].at("distance_m").back(), 0.25)
      << "peaks stay";
}

TEST(CompareReportDataTest, FilesThatDoNotFitAreRefused) {
  const TempFolder folder;
  ExpectInputError([&] { CompareReportData(folder.path()); }, {"config.flags"});
  WriteComparison(folder, 2);
  folder.Write("tables.csv", kTablesHeader);
  ExpectInputError([&] { CompareReportData(folder.path()); },
                   {"tables.csv: no row of tukey on a, b"});
  folder.Write("paths.csv", std::string(kPathsHeader) +
                                "s,truth,1,,,,,,,,,,,\ns,truth,2,,,,,,,,,,,\n"
                                "s,tukey,1,,,,,,,,,,,\n");
  ExpectInputError([&] { CompareReportData(folder.path()); },
                   {"paths.csv: tukey has a different number"});
  // A sweep does not need these files.
  folder.Write("config.flags", "# Experiment\n--experiment=sweep\n");
  ExpectInputError([&] { CompareReportData(folder.path()); }, {"sweep.csv"});
}

}  // namespace
}  // namespace rgbd_pose
