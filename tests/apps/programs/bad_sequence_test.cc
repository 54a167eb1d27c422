// Damaged sequences as input of rgbd_odometry.

#include "core/util/text_file.h"
#include "frontend/files/image_file.h"
#include "tests/support/bad_input.h"

namespace rgbd_pose {
namespace {

using Seq = SpoiledSequence;

const std::string kColor = "rgb/1000.066667.png";
const std::string kDepth = "depth/1000.066667.png";
constexpr int kWidth = 320;
constexpr int kHeight = 240;

// Replaces an image of the sequence.
auto Image(const std::string& name, int type) {
  return [=](const Seq& seq) {
    WritePngFile(seq / name,
                 cv::Mat(kHeight, kWidth, type, cv::Scalar(90, 90, 90)));
  };
}

// Replaces an image by a file of the fuzzers' corpus.
auto Corpus(const std::string& name, const std::string& image) {
  return [=](const Seq& seq) {
    seq.Write(name, ReadTextFile(RGBD_POSE_CORPUS "/image_file/" + image));
  };
}

auto Text(const std::string& name, const std::string& content) {
  return [=](const Seq& seq) { seq.Write(name, content); };
}

auto Swap(const std::string& name, const std::string& from,
          const std::string& to) {
  return [=](const Seq& seq) { seq.Replace(name, from, to); };
}

auto Gone(const std::string& name) {
  return [=](const Seq& seq) { seq.Remove(name); };
}

#ifdef RGBD_POSE_HAS_VIDEOIO
constexpr char kNoVideo[] = "{seq}/rgb.mp4: missing";
constexpr char kBadVideo[] = "{seq}/rgb.mp4: cannot be read as a video";
#else
constexpr char kNoVideo[] = "{seq}: this build cannot read videos; install";
constexpr const char* kBadVideo = kNoVideo;
#endif

TEST_F(BadInputTest, Videos) {
  ExpectEach(Odometry() + "--source=stray_scanner ",
             {
                 {"no video", nullptr, "", 2, kNoVideo},
                 {"garbage", Text("rgb.mp4", "no video"), "", 2, kBadVideo},
                 // FFmpeg has nothing to say of its own.
                 {"cut off",
                  Text("rgb.mp4", std::string("\0\0\0\x18", 4) + "ftypisom"),
                  "", 2, kBadVideo},
             });
}

TEST_F(BadInputTest, Images) {
  // Reading stops at the first damaged image.
  ExpectEach(
      Odometry() + "--validate_only --max_damaged=0 ",
      {
          {"depth cut off", [](const Seq& s) { s.Cut(kDepth, 1000); }, "", 2,
           "{seq}/" + kDepth + ": is damaged or cut off; copy it again"},
          {"colour is garbage", Text(kColor, "garbage, not a picture"), "", 2,
           kColor + ": is damaged, cut off or not in a"},
          {"garbage with right checksums", Corpus(kColor, "no_zlib.png"), "", 2,
           kColor + ": is damaged"},
          {"the same in gray", Corpus(kColor, "no_zlib_gray.png"), "", 2,
           kColor + ": is damaged"},
          {"rows are missing", Corpus(kDepth, "rows_missing.png"), "", 2,
           kDepth + ": is damaged"},
          {"claims 4 Gpixels", Corpus(kColor, "huge.png"), "", 2,
           kColor + ": is "},
          {"claims 900 Mpixels", Corpus(kColor, "large.png"), "", 2,
           kColor + ": is "},
          {"empty", [](const Seq& s) { s.Cut(kDepth, 0); }, "", 2,
           kDepth + ": is empty; copy it again"},
          {"colour in the place of depth",
           [](const Seq& s) { s.Write(kDepth, s.Read(kColor)); }, "", 2,
           "is it the colour image"},
          {"the camera of another size", Swap("camera.yaml", "320", "640"), "",
           2, "the camera has 640 x 240"},
          {"gray for colour", Image(kColor, CV_8UC1), "", 0, ""},
          {"no such image", Gone(kColor), "", 2, "{seq}/" + kColor},
          {"no image at all", Gone("rgb"), "--max_damaged=0.05", 2,
           "{seq}/rgb/1000.000000.png"},
      });
  ExpectEach(
      Odometry(),
      {
          {"no image at all", Gone("rgb"), "", 2, "{seq}/rgb/1000.000000.png"},
          {"all damaged, few allowed", Gone("depth"), "--max_damaged=0", 2,
           "{seq}/depth/1000.000000.png"},
          {"no depth anywhere",
           [](const Seq& s) {
             for (const std::string time :
                  {"000000", "033333", "066667", "100000"}) {
               WritePngFile(s / ("depth/1000." + time + ".png"),
                            cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(0)));
             }
           },
           "", 3, "only 0.0 % of the frames were tracked"},
      });
}

// A damaged image costs its own frame; too many end the run with its results.
TEST_F(BadInputTest, DamagedFrames) {
  for (const std::string& program :
       {Odometry(), Odometry() + "--validate_only ",
        std::string(RGBD_SLAM " --dataset={seq} --output={dir}/out --noreport"),
        std::string(RGBD_CONVERT " --dataset={seq} --output={dir}/out ")}) {
    for (const bool is_gone : {false, true}) {
      SCOPED_TRACE(program);
      Renew();
      if (is_gone) {
        Spoiled().Remove(kDepth);
      } else {
        Spoiled().Cut(kDepth, 1000);
      }
      const RunResult run = RunCommand(Fill(program), folder_);
      EXPECT_EQ(run.exit_code, 0) << run.err;
      EXPECT_THAT(run.err, testing::HasSubstr(Fill("{seq}/" + kDepth)));
      EXPECT_THAT(run.err, testing::HasSubstr("this frame is left out"));
      const std::string metrics = folder_ / "out/metrics.json";
      if (std::filesystem::exists(metrics)) {
        EXPECT_THAT(ReadTextFile(metrics),
                    testing::HasSubstr("\"damaged_frames\": 1"));
      }
      EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    }
  }
}

// One of two equal time stamps is used, and one line of output reports it.
TEST_F(BadInputTest, DoubledTimeStamps) {
  const std::string kSecond = "1000.033333 rgb/1000.033333.png\n";
  const std::string kPose = "1000 0 0 0 0 0 0 1\n";
  const std::string kPair =
      "1000.0 rgb/1000.000000.png 1000.0 depth/1000.000000.png\n";
  const struct {
    std::function<void(const Seq&)> spoil;
    const char* words;
    const char* message;
  } kRows[] = {
      {Swap("rgb.txt", kSecond, kSecond + kSecond), "",
       "{seq}: 1 image has the same time stamp as another and is left out"},
      {Text("list.txt", kPair + kPair), "--associations={seq}/list.txt",
       "{seq}: 1 image has the same time stamp as another"},
      {Text("groundtruth.txt", kPose + kPose), "",
       "{seq}/groundtruth.txt:2: has the same time stamp as the previous pose"},
      {Text("t.txt", kPose + kPose), "--groundtruth={seq}/t.txt",
       "{seq}/t.txt:2: has the same time stamp as the previous pose; 1 such"},
  };
  for (const auto& row : kRows) {
    SCOPED_TRACE(row.message);
    Renew();
    row.spoil(Spoiled());
    const RunResult run =
        RunCommand(Fill(Odometry() + "--on_lost=hold " + row.words), folder_);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.err, testing::HasSubstr(Fill(row.message)));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
}

TEST_F(BadInputTest, TooManyDamagedFramesEndARunWithWhatItHas) {
  for (const std::string& program :
       {Odometry(),
        Fill(RGBD_CONVERT " --dataset={seq} --output={dir}/out ")}) {
    SCOPED_TRACE(program);
    Renew();
    Spoiled().Cut(kDepth, 1000);
    const RunResult run =
        RunCommand(Fill(program + "--max_damaged=0"), folder_);
    EXPECT_EQ(run.exit_code, 6) << run.err;
    EXPECT_THAT(run.err, testing::HasSubstr(
                             "stopped after 2 frames (1 of 3 frames cannot be "
                             "read, the last: " +
                             Fill("{seq}/" + kDepth)));
  }
}

// What else may be wrong in lists and paths is tested where these are read.
TEST_F(BadInputTest, Lists) {
  const std::string kRgb = "{seq}/rgb.txt";
  const std::string kFirst = "1000.033333 rgb/1000.033333.png\n";
  ExpectEach(Odometry(),
             {
                 {"no folder", nullptr, "--dataset={seq}/none", 2,
                  "{seq}/none: no such file or folder"},
                 {"no rgb.txt", Gone("rgb.txt"), "", 2, kRgb + ": missing"},
                 {"no depth.txt", Gone("depth.txt"), "", 2,
                  "{seq}/depth.txt: missing"},
                 {"binary", Text("rgb.txt", std::string("\0\x01\xFF\n\x7F", 5)),
                  "", 2, kRgb + ":1: needs 2 columns"},
                 {"a name with a space", Text("rgb.txt", "1 rgb/my 1.png\n"),
                  "", 2, "names of images must not have spaces: '1 rgb/my 1"},
                 {"intervals for times",
                  Text("rgb.txt", "0.033 a\n0.034 b\n0.033 c\n0.033 d\n"), "",
                  2, kRgb + ":3: the times look like intervals between images"},
                 {"one frame", Text("rgb.txt", kFirst), "", 0, ""},
                 {"no associations", nullptr, "--associations={seq}/list.txt",
                  2, "{seq}/list.txt: cannot be opened"},
                 {"associations without an image",
                  Text("list.txt", "1000 rgb/x.png 1000 depth/x.png\n"),
                  "--associations={seq}/list.txt", 2,
                  "{seq}/rgb/x.png: cannot be opened"},
             });
}

TEST_F(BadInputTest, GroundTruth) {
  const std::string kPose = "1000 0 0 0 0 0 0 1\n";
  ExpectEach(
      Odometry(),
      {
          {"broken", Text("groundtruth.txt", kPose + "1001 0\n"), "", 2,
           "{seq}/groundtruth.txt:2: 2 columns"},
          {"says how to go without it", Text("groundtruth.txt", "1001 0\n"), "",
           2, "--groundtruth=none to run without it"},
          {"of another time", Text("groundtruth.txt", "5 0 0 0 0 0 0 1\n"), "",
           2, "(5.000000 s to 5.000000 s)"},
          {"named but missing", nullptr, "--groundtruth={seq}/none.txt", 2,
           "{seq}/none.txt: cannot be opened"},
          {"a guess of motion that is broken", Text("guess.txt", "1 2\n"),
           "--motion_guess={seq}/guess.txt", 2, "{seq}/guess.txt:1: 2 columns"},
          {"a guess of another time",
           Text("guess.txt", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"),
           "--motion_guess={seq}/guess.txt", 2,
           "{seq}/guess.txt: has no pose at the time of the recording"},
          {"one pose", Text("groundtruth.txt", kPose), "", 0, ""},
      });
}

}  // namespace
}  // namespace rgbd_pose
