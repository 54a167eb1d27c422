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
auto Image(const std::string& name, int type, int width = kWidth) {
  return [=](const Seq& seq) {
    WritePngFile(seq / name,
                 cv::Mat(kHeight, width, type, cv::Scalar(90, 90, 90)));
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

// Rewrites a text file as editors on Windows save it.
auto Windows(const std::string& name) {
  return [=](const Seq& seq) {
    std::string content = "\xEF\xBB\xBF";
    for (const char c : seq.Read(name)) {
      content += c == '\n' ? std::string("\r\n") : std::string(1, c);
    }
    seq.Write(name, content);
  };
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
          {"colour cut off", [](const Seq& s) { s.Cut(kColor, 1000); }, "", 2,
           "{seq}/" + kColor + ": is damaged or cut off; copy it again"},
          {"depth is garbage", Text(kDepth, "garbage, not a picture"), "", 2,
           kDepth + ": is damaged, cut off or not in a"},
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
          {"8-bit depth", Image(kDepth, CV_8UC1), "", 2,
           kDepth + ": a depth image must have 16 bits and 1 channel"},
          {"depth in three channels", Image(kDepth, CV_16UC3), "", 2,
           "this one is CV_16UC3"},
          {"colour in the place of depth",
           [](const Seq& s) { s.Write(kDepth, s.Read(kColor)); }, "", 2,
           "is it the colour image"},
          {"depth in the place of colour",
           [](const Seq& s) { s.Write(kColor, s.Read(kDepth)); }, "", 2,
           kColor + ": a colour image must have 8 bits"},
          {"16-bit colour", Image(kColor, CV_16UC3), "", 2,
           kColor + ": a colour image must have 8 bits"},
          {"depth of another size", Image(kDepth, CV_16UC1, 160), "", 2,
           kDepth + ": is 160 x 240 pixels, the camera has 320 x 240"},
          {"colour of another size", Image(kColor, CV_8UC3, 640), "", 2,
           kColor + ": is 640 x 240 pixels, the camera has 320 x 240"},
          {"the camera of another size", Swap("camera.yaml", "320", "640"), "",
           2, "the camera has 640 x 240"},
          {"gray for colour", Image(kColor, CV_8UC1), "", 0, ""},
          {"no such image", Gone(kColor), "", 2, "{seq}/" + kColor},
          {"no such depth image", Gone(kDepth), "", 2, "{seq}/" + kDepth},
          {"no image at all", Gone("rgb"), "--max_damaged=0.05", 2,
           "{seq}/rgb/1000.000000.png"},
      });
  ExpectEach(
      Odometry(),
      {
          {"no image at all", Gone("rgb"), "", 2, "{seq}/rgb/1000.000000.png"},
          {"all damaged, few allowed", Gone("depth"), "--max_damaged=0", 2,
           "{seq}/depth/1000.000000.png"},
          {"a share below none", nullptr, "--max_damaged=-1", 2,
           "max_damaged must be 0 to 1, a share of the frames"},
          {"a share in percent", nullptr, "--max_damaged=50", 2,
           "max_damaged must be 0 to 1, a share of the frames"},
          {"a share that is no number", nullptr, "--max_damaged=nan", 2,
           "max_damaged must be 0 to 1, a share of the frames"},
          {"no depth anywhere",
           [](const Seq& s) {
             for (const char* time : {"00000", "33333", "66667"}) {
               Image("depth/1000.0" + std::string(time) + ".png", CV_16UC1)(s);
               WritePngFile(s / ("depth/1000.0" + std::string(time) + ".png"),
                            cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(0)));
             }
             WritePngFile(s / "depth/1000.100000.png",
                          cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(0)));
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
      std::filesystem::remove_all(Spoiled().path);
      std::filesystem::remove_all(folder_ / "out");
      std::filesystem::copy(folder_ / "good", Spoiled().path,
                            std::filesystem::copy_options::recursive);
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
    std::filesystem::remove_all(Spoiled().path);
    std::filesystem::copy(folder_ / "good", Spoiled().path,
                          std::filesystem::copy_options::recursive);
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
    std::filesystem::remove_all(Spoiled().path);
    std::filesystem::remove_all(folder_ / "out");
    std::filesystem::copy(folder_ / "good", Spoiled().path,
                          std::filesystem::copy_options::recursive);
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

TEST_F(BadInputTest, Lists) {
  const std::string kRgb = "{seq}/rgb.txt";
  const std::string kFirst = "1000.033333 rgb/1000.033333.png\n";
  ExpectEach(
      Odometry(),
      {
          {"no folder", nullptr, "--dataset={seq}/none", 2,
           "{seq}/none: no such file or folder"},
          {"no rgb.txt", Gone("rgb.txt"), "", 2, kRgb + ": missing"},
          {"no depth.txt", Gone("depth.txt"), "", 2,
           "{seq}/depth.txt: missing"},
          {"rgb.txt is a folder",
           [](const Seq& s) {
             s.Remove("rgb.txt");
             std::filesystem::create_directory(s / "rgb.txt");
           },
           "", 2, kRgb + ": is a folder"},
          {"empty", Text("rgb.txt", ""), "", 2, kRgb + ": lists no images"},
          {"only comments", Text("depth.txt", "# a\n\n# b"), "", 2,
           "{seq}/depth.txt: lists no images"},
          {"three columns", Swap("rgb.txt", kFirst, "1000.03 a b\n"), "", 2,
           kRgb + ":3: needs 2 columns (time image), has 3: '1000.03 a b'"},
          {"one column", Swap("rgb.txt", kFirst, "1000.03\n"), "", 2,
           kRgb + ":3: needs 2 columns"},
          {"a word for the time", Swap("rgb.txt", kFirst, "soon a\n"), "", 2,
           kRgb + ":3: 'soon' is not a finite number for the time stamp"},
          {"nan for the time", Swap("rgb.txt", kFirst, "nan a\n"), "", 2,
           kRgb + ":3: 'nan' is not a finite number"},
          {"binary", Text("rgb.txt", std::string("\0\x01\xFF\n\x7F", 5)), "", 2,
           kRgb + ":1: needs 2 columns"},
          {"nanoseconds", Swap("rgb.txt", kFirst, "1305031102175304000 a\n"),
           "", 2,
           kRgb + ":3: time stamp 1305031102175304000 is not in "
                  "seconds"},
          {"intervals for times",
           Text("rgb.txt", "0.033 a\n0.034 b\n0.033 c\n0.033 d\n"), "", 2,
           kRgb + ":3: the times look like intervals between images"},
          {"time goes backwards", Swap("rgb.txt", "1000.1", "999.1"), "", 2,
           kRgb + ":5: the time stamp is earlier than the previous one"},
          {"no depth image near", Text("depth.txt", "5 depth/x.png\n"), "", 2,
           "no image of rgb.txt is within 0.02"},
          {"one frame", Text("rgb.txt", kFirst), "", 0, ""},
          {"CRLF and a byte order mark in rgb.txt", Windows("rgb.txt"), "", 0,
           ""},
          {"the same in depth.txt", Windows("depth.txt"), "", 0, ""},
          {"no line end at the end", Text("rgb.txt", kFirst.substr(0, 31)), "",
           0, ""},
      });
}

TEST_F(BadInputTest, Associations) {
  const std::string kPair =
      "1000.0 rgb/1000.000000.png 1000.0 depth/1000.000000.png\n";
  const auto list = [](const std::string& text) {
    return Text("list.txt", text);
  };
  ExpectEach(
      Odometry() + "--associations={seq}/list.txt ",
      {
          {"missing", nullptr, "", 2, "{seq}/list.txt: cannot be opened"},
          {"empty", list(""), "", 2, "{seq}/list.txt: lists no images"},
          {"three columns", list("1 a 1\n"), "", 2, "list.txt:1: needs 4 col"},
          {"a word for the time", list("1 " + kPair.substr(7, 19) + " x y\n"),
           "", 2, "list.txt:1: 'x' is not a finite number"},
          {"no such image", list("1000 rgb/x.png 1000 depth/x.png\n"), "", 2,
           "{seq}/rgb/x.png: cannot be opened"},
          {"colour twice",
           list("1 rgb/1000.000000.png 1 rgb/1000.033333.png\n"), "", 2,
           "list.txt:1: one image of a line must be colour and one depth"},
          {"depth first",
           list("1000 depth/1000.000000.png 1000 rgb/1000.000000.png\n"), "", 0,
           ""},
          {"CRLF and a byte order mark",
           list("\xEF\xBB\xBF" + kPair.substr(0, kPair.size() - 1) + "\r\n"),
           "", 0, ""},
      });
}

TEST_F(BadInputTest, GroundTruth) {
  const std::string kFile = "{seq}/groundtruth.txt";
  const auto truth = [](const std::string& line) {
    return Text("groundtruth.txt", "1000 0 0 0 0 0 0 1\n" + line + "\n");
  };
  ExpectEach(
      Odometry(),
      {
          {"nan", truth("1001 nan 0 0 0 0 0 1"), "", 2,
           kFile + ":2: 'nan' is not a finite number for tx"},
          {"infinite", truth("1001 0 0 inf 0 0 0 1"), "", 2,
           kFile + ":2: 'inf' is not a finite number for tz"},
          {"beyond any number", truth("1001 0 0 1e999 0 0 0 1"), "", 2,
           kFile + ":2: '1e999' is not a finite number for tz"},
          {"far away", truth("1001 0 1e200 0 0 0 0 1"), "", 2,
           kFile + ":2: the position (columns 2 to 4) is more than 1e9 m away"},
          {"no unit quaternion", truth("1001 0 0 0 0 0 1 1"), "", 2,
           kFile + ":2: the quaternion (columns 5 to 8, qx qy qz qw) is not"},
          {"no quaternion at all", truth("1001 0 0 0 0 0 0 0"), "", 2,
           kFile + ":2: the quaternion"},
          {"seven columns", truth("1001 0 0 0 0 0 1"), "", 2,
           kFile + ":2: 7 columns; a pose needs 8"},
          {"time goes backwards", truth("999 0 0 0 0 0 0 1"), "", 2,
           kFile + ":2: time stamp 999 is earlier than the previous one"},
          {"nanoseconds", truth("1305031102175304000 0 0 0 0 0 0 1"), "", 2,
           kFile + ":2: time stamp 1305031102175304000 is not in seconds"},
          {"empty", Text("groundtruth.txt", ""), "", 2,
           kFile + ": contains no poses"},
          {"of another time", Text("groundtruth.txt", "5 0 0 0 0 0 0 1\n"), "",
           2, "(5.000000 s to 5.000000 s)"},
          {"says how to go without it", truth("1001 0"), "", 2,
           "--groundtruth=none to run without it"},
          {"named but missing", nullptr, "--groundtruth={seq}/none.txt", 2,
           "{seq}/none.txt: cannot be opened"},
          {"a guess of motion that is broken", Text("guess.txt", "1 2\n"),
           "--motion_guess={seq}/guess.txt", 2, "{seq}/guess.txt:1: 2 columns"},
          {"a guess of another time",
           Text("guess.txt", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"),
           "--motion_guess={seq}/guess.txt", 2,
           "{seq}/guess.txt: has no pose at the time of the recording"},
          {"one pose", truth(""), "", 0, ""},
          {"CRLF and a byte order mark", Windows("groundtruth.txt"), "", 0, ""},
      });
}

}  // namespace
}  // namespace rgbd_pose
