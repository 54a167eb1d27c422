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
  const auto estimate = [](const std::string& text) {
    return TextFile("estimate.txt", text);
  };
  const auto same = [](const Seq& s) {
    s.Write("estimate.txt", s.Read("groundtruth.txt"));
  };
  ExpectEach(
      RGBD_EVALUATE
      " --estimate={seq}/estimate.txt --groundtruth={seq}/groundtruth.txt ",
      {
          {"no estimate named", same, "--estimate=", 1, "--estimate is needed"},
          {"no truth named", same, "--groundtruth=", 1,
           "--groundtruth is needed"},
          {"unknown flag", same, "--estimates=x", 2, "unknown flag --estimat"},
          {"no flag", same, "{seq}/estimate.txt", 2,
           "'{seq}/estimate.txt' is not a flag"},
          {"no number", same, "--max_time_difference=soon", 2,
           "'soon' is not a valid double for --max_time_difference"},
          {"no number of frames", same, "--rpe_frames=1,", 2,
           "--rpe_frames=1,: '' is not a number of frames"},
          {"no frames", same, "--rpe_frames=0", 2,
           "'0' is not a number of frames"},
          {"a trajectory and a run", same, "--run={seq}", 2,
           "--run contains a trajectory"},
          {"no run", same, "--estimate= --run={seq}/none", 2,
           "{seq}/none/trajectory.txt: cannot be opened"},
          {"a truth better than exact", same, "--truth_sigma_degrees=-2", 2,
           "sigmas of the ground truth must not be negative"},
          {"missing", nullptr, "", 2, "{seq}/estimate.txt: cannot be opened"},
          {"the truth is missing", same, "--groundtruth={seq}/none.txt", 2,
           "{seq}/none.txt: cannot be opened"},
          {"a folder", same, "--estimate={seq}", 2, "{seq}: is a folder"},
          {"empty", estimate("# nothing\n"), "", 2,
           "{seq}/estimate.txt: contains no poses"},
          {"a word", estimate("0 0 0 0 0 0 0 1\n1 oops 0 0 0 0 0 1\n"), "", 2,
           "{seq}/estimate.txt:2: 'oops' is not a finite number for tx"},
          {"of another time", estimate("5 0 0 0 0 0 0 1\n"), "", 2,
           "no pose of the estimate (5.000000 s to 5.000000 s) is within 0.02"},
          {"negative tolerance", same, "--max_time_difference=-1", 2,
           "must not be negative"},
          {"no tolerance at all", same, "--max_time_difference=nan", 2,
           "must not be negative"},
          {"a tolerance beyond the interval", same, "--max_time_difference=2",
           2, "must be longer than the largest time difference"},
          {"no distance", same, "--rpe_delta_metres=0", 2, "must be positive"},
          {"no folder for the result", same, "--aligned={seq}/none/a.txt", 2,
           "{seq}/none/a.txt: cannot be written (No such file or directory)"},
          {"CRLF and a byte order mark",
           [same](const Seq& s) {
             same(s);
             s.Replace("estimate.txt", "#", "\xEF\xBB\xBF#");
             s.Replace("estimate.txt", "\n", "\r\n");
           },
           "", 0, ""},
          {"one pose", estimate("1000 0 0 0 0 0 0 1\n"), "", 0, ""},
      });
}

TEST_F(BadInputTest, Simulate) {
  ExpectEach(
      RGBD_SIMULATE " --frames=2 --output={dir}/out ",
      {
          {"no output", nullptr, "--output=", 1, "--output is needed"},
          {"path", nullptr, "--path=zigzag", 2, "pan_tilt"},
          {"scene", nullptr, "--scene=moon", 2, "unknown scene 'moon'"},
          {"no frames", nullptr, "--frames=0", 2, "has 1 to 1000000 frames"},
          {"far too many frames", nullptr, "--frames=2000000000", 2,
           "has 1 to 1000000 frames, not 2000000000"},
          {"negative seed", nullptr, "--seed=-1", 2,
           "'-1' is not a valid uint32 for --seed"},
          {"negative exposure", nullptr, "--exposure=-1", 2,
           "the shutter time of a"},
          {"an exposure that is no number", nullptr, "--exposure=nan", 2,
           "the shutter time of a"},
          {"infinite drift", nullptr, "--exposure_drift=inf", 2,
           "exposure_drift of"},
          {"colour of the frame after", nullptr, "--color_time_offset=0.04", 2,
           "color_time_offset of a"},
          {"slow readout", nullptr, "--color_readout=0.04", 2,
           "color_readout of a"},
          {"slow readout, upwards", nullptr, "--depth_readout=-0.04", 2,
           "depth_readout of a"},
          {"depth of no time", nullptr, "--depth_time_offset=nan", 2,
           "depth_time_offset of a"},
          {"a slow camera", nullptr, "--rate=2 --color_readout=0.2", 2,
           "must be at most 0.1 s in magnitude, as in camera files"},
          {"depth of the next frame", nullptr, "--depth_delay=0.02", 2,
           "the depth delay of a"},
          {"a shift out of sight", nullptr, "--registration_shift=2", 2,
           "the registration error of a"},
          {"a turn that is no number", nullptr, "--registration_turn=nan", 2,
           "the registration error of a"},
          {"camera", nullptr, "--camera=kinnect", 2, "camera 'kinnect'"},
      });
}

TEST_F(BadInputTest, Convert) {
  ExpectEach(
      RGBD_CONVERT " --dataset={seq} --output={dir}/out ",
      {
          {"no dataset", nullptr, "--dataset=", 1, "--dataset is needed"},
          {"no output", nullptr, "--output=", 1, "--output is needed"},
          {"of no kind", nullptr, "--dataset={dir}", 2,
           "{dir}: is not a supported recording: contains"},
          {"an output that is there", nullptr, "--output={dir}/good", 2,
           "{dir}/good: already exists and is not an empty folder"},
          {"broken images", [](const Seq& s) { s.Remove("depth"); }, "", 2,
           "depth/1000.000000.png: cannot be opened"},
          {"a broken ground truth",
           [](const Seq& s) { s.Write("groundtruth.txt", "1 2 3\n"); }, "", 2,
           "{seq}/groundtruth.txt:1"},
          {"unwanted ground truth",
           [](const Seq& s) { s.Write("groundtruth.txt", "1 2 3\n"); },
           "--groundtruth=none", 0, ""},
      });
}

TEST_F(BadInputTest, Compare) {
  ExpectEach(
      RGBD_COMPARE " --frames=2 --output={dir}/out ",
      {
          {"no experiment", nullptr, "", 1, "--experiment is needed"},
          {"no output", nullptr, "--experiment=xyz --output=", 1, "--output"},
          {"unknown experiment", nullptr, "--experiment=abc", 2,
           "--experiment=abc is neither pan_tilt, xyz or sweep nor a folder"},
          {"no camera", nullptr, "--experiment={seq}", 1, "--camera is needed"},
          {"unknown loss", nullptr, "--experiment=xyz --losses=tuckey", 2,
           "--losses: unknown loss 'tuckey'"},
          {"no loss", nullptr, "--experiment=xyz --losses=tukey,", 2,
           "--losses: unknown loss ''"},
          {"a loss twice", nullptr, "--experiment=xyz --losses=tukey,tukey", 2,
           "--losses: 'tukey' appears twice"},
          {"only a comma", nullptr, "--experiment=xyz --losses=,", 2,
           "--losses: unknown loss ''"},
          {"unknown cost", nullptr, "--experiment=sweep --cost=magic", 2,
           "unknown cost 'magic'"},
          {"unknown frontend", nullptr, "--experiment=xyz --frontend=magic", 2,
           "unknown frontend 'magic'"},
          {"no trials", nullptr, "--experiment=sweep --seeds=0", 2,
           "--seeds must be 1 to 100000"},
          {"no frames", nullptr, "--experiment=xyz --frames=0", 2,
           "has 1 to 1000000 frames"},
          {"a broken ground truth",
           [](const Seq& s) { s.Write("groundtruth.txt", "1 2 3\n"); },
           "--experiment={seq} --camera={seq}/camera.yaml", 2,
           "{seq}/groundtruth.txt:1"},
          {"broken images", [](const Seq& s) { s.Remove("depth"); },
           "--experiment={seq} --camera={seq}/camera.yaml", 2,
           "depth/1000.000000.png: cannot be opened"},
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
  const std::string kCounts = "\"degrees_counts\": [";
  ExpectEach(
      RGBD_REPORT " ",
      {
          {"nothing named", nullptr, "", 1, "--run is needed"},
          {"both", nullptr, "--run=a --batch=b", 2, "give only one of --run"},
          {"no folder", nullptr, "--run={seq}/none", 2,
           "{seq}/none/frames.csv: cannot be opened"},
          {"no batch", nullptr, "--batch={seq}", 2,
           "{seq}/summary.csv: cannot be opened"},
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
  ExpectEach(
      RGBD_EXPORT " --run={seq} --to=colmap --output={dir}/out ",
      {
          {"no run named", LeaveRun, "--run=", 1, "--run is needed"},
          {"no format", LeaveRun, "--to=", 1, "--to is needed"},
          {"unknown format", LeaveRun, "--to=obj", 2,
           "unknown format 'obj'; available: mesh, cloud, colmap, nerfstudio"},
          {"the run is missing", nullptr, "--run={dir}/none", 2,
           "--run: {dir}/none: no such folder"},
          {"no run", nullptr, "", 2, "{seq} has no frames.csv"},
          {"a run without flags",
           RunAnd([](const Seq& s) { s.Remove("config.flags"); }), "", 2,
           "{seq} has no config.flags"},
          {"a run without poses",
           RunAnd([](const Seq& s) { s.Remove("trajectory.txt"); }), "", 2,
           "{seq}/trajectory.txt: cannot be opened"},
          {"frames that have no pose", RunAnd([](const Seq& s) {
             s.Write("frames.csv", "timestamp,status,segment\n0,ok,0\n");
           }),
           "", 2, "4 poses, but 1 tracked frames in frames.csv"},
          {"all lost", RunAnd([](const Seq& s) {
             s.Write("frames.csv", "timestamp,status,segment\n0,lost,0\n");
           }),
           "", 2, "no frame of the run has a pose"},
          {"the recording is gone", RunAnd([](const Seq& s) {
             s.Replace("config.flags", s.path, "/nowhere");
           }),
           "", 2, "/nowhere, does not exist; give its location with --dataset"},
          {"images are gone", RunAnd([](const Seq& s) { s.Remove("rgb"); }), "",
           2, "{seq}/rgb"},
          {"of another recording", RunAnd([](const Seq& s) {
             s.Write("trajectory.txt",
                     "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n3 0 0 0 0 0 0 1\n"
                     "4 0 0 0 0 0 0 1\n");
           }),
           "", 2, "the recording has no frame at 1.000000 s"},
          {"an image is cut off", RunAnd([](const Seq& s) {
             for (const auto& file :
                  std::filesystem::directory_iterator(s / "rgb")) {
               std::filesystem::resize_file(file, 1000);
             }
           }),
           "", 2, "{seq}/rgb/"},
          {"a mesh of an unknown kind", LeaveRun,
           "--to=mesh --output={dir}/mesh.obj", 2,
           "mesh.obj: the name of a mesh must end in one of .ply, .glb"},
          {"a mesh nowhere", LeaveRun, "--to=mesh --output={dir}/none/mesh.ply",
           2, "{dir}/none/mesh.ply: cannot be written"},
          {"voxels without size", LeaveRun,
           "--to=mesh --output={dir}/mesh.ply --voxel=0", 2,
           "--voxel or --max_depth: the voxel size must be 0.001 to 1 m"},
          {"no depth at all", LeaveRun,
           "--to=cloud --output={dir}/cloud.ply --max_depth=0.1", 2,
           "--voxel or --max_depth: depth limits must satisfy"},
          {"a negative turn", LeaveRun, "--min_angle=-1", 2,
           "must not be negative"},
          {"no points", LeaveRun, "--max_points=1", 2,
           "--max_points must be 8 or more"},
          {"a folder that is not empty", LeaveRun, "--output={seq}", 2,
           "{seq} is not empty; use --overwrite to replace it"},
          {"a folder of others", LeaveRun, "--output={seq} --overwrite", 2,
           "{seq} contains other files"},
          {"a file for a folder", LeaveRun, "--output={seq}/rgb.txt", 2,
           "{seq}/rgb.txt is a file; a folder is needed"},
          {"all is well", LeaveRun, "", 0, ""},
      });
}

}  // namespace
}  // namespace rgbd_pose
