// Bad input of the programs other than rgbd_odometry.

#include <filesystem>
#include <functional>

#include "tests/support/bad_input.h"

namespace rgbd_pose {
namespace {

using Seq = SpoiledSequence;

auto TextFile(const std::string& name, const std::string& content) {
  return [=](const Seq& seq) { seq.Write(name, content); };
}

TEST_F(BadInputTest, Evaluate) {
  const std::string kEvaluate = RGBD_EVALUATE
      " --estimate={seq}/estimate.txt --groundtruth={seq}/groundtruth.txt ";
  const auto estimate = [](const std::string& text) {
    return TextFile("estimate.txt", text);
  };
  const auto same = [](const Seq& s) {
    s.Write("estimate.txt", s.Read("groundtruth.txt"));
  };
  ExpectNeeded(kEvaluate, {"--estimate", "--groundtruth"});
  ExpectRefused(
      kEvaluate,
      {
          {"--estimates=x", "unknown flag --estimat"},
          {"{seq}/estimate.txt", "'{seq}/estimate.txt' is not a flag"},
          {"--max_time_difference=soon",
           "'soon' is not a valid double for --max_time_difference"},
          {"--max_time_difference=-1", "must not be negative"},
          {"--max_time_difference=nan", "must not be negative"},
          {"--max_time_difference=2",
           "must be longer than the largest time difference"},
          {"--rpe_frames=1,", "--rpe_frames=1,: '' is not a number of frames"},
          {"--rpe_frames=0", "'0' is not a number of frames"},
          {"--rpe_delta_metres=0", "must be positive"},
          {"--truth_sigma_degrees=-2",
           "sigmas of the ground truth must not be negative"},
          {"--truth_sigma_metres=inf",
           "sigmas of the ground truth must not be negative or infinite"},
          {"--run={seq}", "--run contains a trajectory"},
          {"--estimate= --run={seq}/none",
           "{seq}/none/trajectory.txt: cannot be opened"},
          {"--estimate={seq}", "{seq}: is a folder"},
          {"--groundtruth={seq}/none.txt", "{seq}/none.txt: cannot be opened"},
          {"--aligned={seq}/estimate.txt",
           "would replace {seq}/estimate.txt, which is read; choose another"},
          {"--aligned={seq}/groundtruth.txt",
           "would replace {seq}/groundtruth.txt, which is read"},
          {"--aligned={seq}/none/a.txt",
           "{seq}/none/a.txt: cannot be written (No such file or directory)"},
      },
      same);
  ExpectEach(
      kEvaluate,
      {
          {"missing", nullptr, "", 2, "{seq}/estimate.txt: cannot be opened"},
          {"empty", estimate("# nothing\n"), "", 2,
           "{seq}/estimate.txt: contains no poses"},
          {"of another time", estimate("5 0 0 0 0 0 0 1\n"), "", 2,
           "no pose of the estimate (5.000000 s to 5.000000 s) is within 0.02"},
          {"one pose", estimate("1000 0 0 0 0 0 0 1\n"), "", 0, ""},
      });
}

TEST_F(BadInputTest, Simulate) {
  const std::string kSimulate = RGBD_SIMULATE " --frames=2 --output={dir}/out ";
  ExpectNeeded(kSimulate, {"--output"});
  ExpectRefused(
      kSimulate,
      {
          {"--path=zigzag", "pan_tilt"},
          {"--scene=moon", "unknown scene 'moon'"},
          {"--camera=kinnect", "camera 'kinnect'"},
          {"--frames=0", "has 1 to 1000000 frames"},
          {"--frames=2000000000", "has 1 to 1000000 frames, not 2000000000"},
          {"--seed=-1", "'-1' is not a valid uint32 for --seed"},
          {"--exposure=-1", "the shutter time of a"},
          {"--exposure=nan", "the shutter time of a"},
          {"--exposure_drift=inf", "exposure_drift of"},
          // Of the next frame, or infinitely slow.
          {"--color_time_offset=0.04", "color_time_offset of a"},
          {"--color_readout=0.04", "color_readout of a"},
          {"--depth_readout=-0.04", "depth_readout of a"},
          {"--depth_time_offset=nan", "depth_time_offset of a"},
          {"--rate=2 --color_readout=0.2",
           "must be at most 0.1 s in magnitude, as in camera files"},
          {"--depth_delay=0.02", "the depth delay of a"},
          {"--registration_shift=2", "the registration error of a"},
          {"--registration_turn=nan", "the registration error of a"},
          {"--registration_turn=400", "must be at most 45 degrees"},
          {"--imu_gyro_bias=0.1", "--imu_gyro_bias and --imu_accel_bias need"},
          {"--imu_noise=false", "--imu_accel_bias need --imu"},
      });
}

TEST_F(BadInputTest, Convert) {
  const std::string kConvert =
      RGBD_CONVERT " --dataset={seq} --output={dir}/out ";
  const auto bad_truth = TextFile("groundtruth.txt", "1 2 3\n");
  ExpectNeeded(kConvert, {"--dataset", "--output"});
  ExpectRefused(
      kConvert,
      {{"--dataset={dir}", "{dir}: is not a supported recording: contains"},
       {"--output={dir}/good",
        "{dir}/good: already exists and is not an empty folder"}});
  ExpectEach(
      kConvert,
      {
          {"broken images", [](const Seq& s) { s.Remove("depth"); }, "", 2,
           "depth/1000.000000.png: cannot be opened"},
          {"a broken ground truth", bad_truth, "", 2,
           "{seq}/groundtruth.txt:1"},
          {"unwanted ground truth", bad_truth, "--groundtruth=none", 0, ""},
      });
}

TEST_F(BadInputTest, Compare) {
  const std::string kCompare = RGBD_COMPARE " --frames=2 --output={dir}/out ";
  const std::string kFolder = "--experiment={seq} --camera={seq}/camera.yaml ";
  ExpectNeeded(kCompare, {"--experiment"});
  ExpectNeeded(kCompare + "--experiment=xyz ", {"--output"});
  ExpectNeeded(kCompare + "--experiment={seq} ", {"--camera"});
  ExpectRefused(
      kCompare + "--experiment=xyz ",
      {
          {"--experiment=abc",
           "--experiment=abc is neither pan_tilt, xyz or sweep nor a folder"},
          {"--losses=tuckey", "--losses: unknown loss 'tuckey'"},
          {"--losses=tukey,", "--losses: unknown loss ''"},
          {"--losses=,", "--losses: unknown loss ''"},
          {"--losses=tukey,tukey", "--losses: 'tukey' appears twice"},
          {"--experiment=sweep --cost=magic", "unknown cost 'magic'"},
          {"--experiment=sweep --seeds=0", "--seeds must be 1 to 100000"},
          {"--frontend=magic", "unknown frontend 'magic'"},
          {"--frames=0", "has 1 to 1000000 frames"},
      });
  ExpectEach(
      kCompare + kFolder,
      {
          {"a broken ground truth", TextFile("groundtruth.txt", "1 2 3\n"), "",
           2, "{seq}/groundtruth.txt:1"},
          {"broken images", [](const Seq& s) { s.Remove("depth"); }, "", 2,
           "depth/1000.000000.png: cannot be opened"},
      });
}

TEST_F(BadInputTest, Maps) {
  ExpectRefused(
      RGBD_SLAM " --dataset={seq} --output={dir}/out --noreport ",
      {
          {"--localise_only", "--localise_only needs --load_map"},
          {"--load_map=nowhere",
           "--load_map: nowhere: no such folder; choose a "},
          {"--load_map=map,map", "--load_map: 'map' appears twice"},
          {"--load_map=nowhere --calibrate", "--calibrate changes the camera"},
          {"--max_pairs=0", "max_pairs must be at least 1"},
          {"--save_map={dir}/out", "--save_map: must be another folder than "},
          {"--save_map={dir}/none/../out/",
           "--save_map: must be another folder than "},
          {"--save_map={dir}", "--save_map: must be another folder than "},
          {"--save_map={seq}/map", "is in the recording's own folder {seq}"},
      });
}

TEST_F(BadInputTest, Report) {
  const RunResult probe =
      RunCommand(RGBD_REPORT " --run=" + folder_.path(), folder_);
  if (probe.err.find("built without plotly.js") != std::string::npos) {
    GTEST_SKIP() << "built without plotly.js";
  }
  ASSERT_EQ(RunCommand(Fill(RGBD_ODOMETRY
                            " --dataset={dir}/good --noreport --output={dir}/"
                            "run --camera={dir}/good/camera.yaml"),
                       folder_)
                .exit_code,
            0);
  // A copy of that run with one file changed; an empty `from` removes the file.
  const auto run = [this](const std::string& file, const std::string& from,
                          const std::string& to) {
    return [=](const Seq& seq) {
      std::filesystem::remove_all(seq.path);
      std::filesystem::copy(folder_ / "run", seq.path,
                            std::filesystem::copy_options::recursive);
      from.empty() ? seq.Remove(file) : seq.Replace(file, from, to);
    };
  };
  ExpectNeeded(RGBD_REPORT " ", {"--run"});
  ExpectRefused(
      RGBD_REPORT " ",
      {
          {"--run=a --batch=b", "give only one of --run"},
          {"--run={seq}/none", "{seq}/none/frames.csv: cannot be opened"},
          {"--batch={seq}", "{seq}/summary.csv: cannot be opened"},
      });
  const std::string kCounts = "\"degrees_counts\": [";
  ExpectEach(
      RGBD_REPORT " ",
      {
          {"an empty table", TextFile("summary.csv", ""), "--batch={seq}", 2,
           "{seq}/summary.csv:1: no column 'sequence'"},
          {"a table of too few columns",
           TextFile("summary.csv", "sequence,cost\na\n"), "--batch={seq}", 2,
           "{seq}/summary.csv:2: 1 cells, but 2 column names"},
          {"no metrics", run("metrics.json", "", ""), "--run={seq}", 2,
           "{seq}/metrics.json: cannot be opened"},
          {"metrics that are no JSON", run("metrics.json", "{", ""),
           "--run={seq}", 2, "{seq}/metrics.json: is not a JSON object"},
          {"words for figures",
           run("metrics.json", kCounts, kCounts + "\"a\","), "--run={seq}", 2,
           "{seq}/metrics.json: no list of numbers at /residuals/degrees_cou"},
          {"no figures", run("metrics.json", kCounts, "\"other\": ["),
           "--run={seq}", 2, "{seq}/metrics.json: no list of numbers at"},
          {"no settings", run("config.flags", "", ""), "--run={seq}", 2,
           "{seq}/config.flags: cannot be opened"},
          {"a word for a number", run("frames.csv", ",ok,\"\",0", ",ok,\"\",a"),
           "--run={seq}", 2, "{seq}/frames.csv:2: 'a' is not a finite number"},
          {"errors of no columns", run("errors.csv", "true_x", "x_true"),
           "--run={seq}", 2, "{seq}/errors.csv:1: no column 'true_x'"},
          {"no poses",
           [run](const Seq& s) {
             run("errors.csv", "", "")(s);
             s.Write("trajectory.txt", "");
           },
           "--run={seq}", 2, "{seq}/trajectory.txt: contains no poses"},
      });
}

// Writes the results that a run in the folder of its recording would leave.
void LeaveRun(const Seq& s) {
  s.Write("config.flags", "# Input\n--dataset=" + s.path +
                              "\n--camera=" + s / "camera.yaml" + "\n");
  s.Write("frames.csv",
          "timestamp,status,segment\n0,ok,0\n0,ok,0\n0,ok,0\n0,ok,0\n");
  s.Write("trajectory.txt", s.Read("groundtruth.txt"));
}

auto RunAnd(const std::function<void(const Seq&)>& spoil) {
  return [spoil](const Seq& s) {
    LeaveRun(s);
    spoil(s);
  };
}

TEST_F(BadInputTest, Export) {
  const std::string kExport =
      RGBD_EXPORT " --run={seq} --to=colmap --output={dir}/out ";
  ExpectNeeded(kExport, {"--run", "--to"});
  ExpectRefused(
      kExport,
      {
          {"--to=obj",
           "unknown format 'obj'; available: mesh, cloud, colmap, nerfstudio"},
          {"--run={dir}/none", "--run: {dir}/none: no such folder"},
          {"--run= --map={dir}/none", "{dir}/none: no such folder; choose a"},
          {"--map={dir}/none", "--map: a map has its own images; leave out"},
          {"--to=mesh --output={dir}/mesh.obj",
           "mesh.obj: the name of a mesh must end in one of .ply, .glb"},
          {"--to=mesh --output={dir}/none/mesh.ply",
           "{dir}/none/mesh.ply: cannot be written"},
          {"--to=mesh --output={dir}/mesh.ply --voxel=0",
           "--voxel or --max_depth: the voxel size must be 0.001 to 1 m"},
          {"--to=cloud --output={dir}/cloud.ply --max_depth=0.1",
           "--voxel or --max_depth: depth limits must satisfy"},
          {"--min_angle=-1", "must not be negative"},
          {"--max_points=1", "--max_points must be 8 or more"},
          {"--output={dir}", "{dir} is not empty; use --overwrite to replace"},
          {"--output={dir} --overwrite", "{dir} contains other files"},
          {"--output={dir}/mine", "{dir}/mine is a file; a folder is needed"},
          {"--to=tum --output={seq}/rgb.txt",
           "--output={seq}/rgb.txt: is in the recording's own folder {seq}"},
          {"--to=mcap --dataset={dir}/mine --output={dir}/mine",
           "--output={dir}/mine: is the recording itself"},
          {"--run={dir}/loop", "--run: {dir}/loop: no such folder"},
          {"--output={dir}/loop",
           "rgbd_export: {dir}/loop: Too many levels of symbolic links; check"},
      },
      RunAnd([](const Seq& s) {
        s.Write("../mine", "mine");
        std::error_code is_there;
        std::filesystem::create_symlink("loop", s / "../loop", is_there);
      }));
  ExpectEach(
      kExport,
      {
          {"no run", nullptr, "", 2, "{seq} has no frames.csv"},
          {"a run without flags",
           RunAnd([](const Seq& s) { s.Remove("config.flags"); }), "", 2,
           "{seq} has no config.flags"},
          {"a run without poses",
           RunAnd([](const Seq& s) { s.Remove("trajectory.txt"); }), "", 2,
           "{seq}/trajectory.txt: cannot be opened"},
          {"frames that have no pose",
           RunAnd(TextFile("frames.csv", "timestamp,status,segment\n0,ok,0\n")),
           "", 2, "4 poses, but 1 tracked frames in frames.csv"},
          {"all lost",
           RunAnd(
               TextFile("frames.csv", "timestamp,status,segment\n0,lost,0\n")),
           "", 2, "no frame of the run has a pose"},
          {"the recording is gone", RunAnd([](const Seq& s) {
             s.Replace("config.flags", s.path, "/nowhere");
           }),
           "", 2, "/nowhere, does not exist; give its location with --dataset"},
          {"images are gone", RunAnd([](const Seq& s) { s.Remove("rgb"); }), "",
           2, "{seq}/rgb"},
          {"of another recording",
           RunAnd(TextFile("trajectory.txt",
                           "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"
                           "3 0 0 0 0 0 0 1\n4 0 0 0 0 0 0 1\n")),
           "", 2, "the recording has no frame at 1.000000 s"},
          {"an image is cut off", RunAnd([](const Seq& s) {
             for (const auto& file :
                  std::filesystem::directory_iterator(s / "rgb")) {
               std::filesystem::resize_file(file, 1000);
             }
           }),
           "", 2, "{seq}/rgb/"},
          {"all is well", LeaveRun, "", 0, ""},
      });
}

}  // namespace
}  // namespace rgbd_pose
