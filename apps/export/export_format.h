#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/results/run_output.h"
#include "core/evaluation/trajectory.h"
#include "core/util/input_error.h"
#include "core/util/locked_folder.h"
#include "frontend/frame/frame.h"
#include "frontend/fusion/cloud_fusion.h"
#include "frontend/settings/sequence.h"
#include "frontend/settings/settings.h"
#include "frontend/slam/keyframe_map.h"

namespace rgbd_pose {

// Stamps of files have 6 decimals: closer ones are the same, s.
constexpr double kSameTime = 1e-5;

// A finished run of rgbd_odometry or rgbd_slam, read from its folder, a path
// that was tracked without them, or a map.
struct FinishedRun {
  using Open = std::function<std::unique_ptr<FrameSource>()>;

  // Reads the poses and settings. `dataset` and `camera`, unless empty,
  // override those of the run, because the recording may have moved. Throws
  // InputError for a folder without a run or with broken files.
  explicit FinishedRun(const std::string& run_folder,
                       const std::string& dataset = "",
                       const std::string& camera = "");

  // A path in one world, without a folder. `open` opens its recording with
  // colour. Throws InputError for a path without poses.
  FinishedRun(Trajectory path, Open open);

  std::string folder;                      // of its results; empty: none
  std::shared_ptr<const KeyframeMap> map;  // null if it is no map
  Open open;                               // only without a folder
  SequenceSettings sequence;  // with which the recording was opened
  OdometrySettings odometry;  // with which it was tracked

  // The poses of all frames that have one. Of each: the number of its frame (a
  // row of frames.csv; without a folder that of the pose) and its segment.
  // Segments have unrelated worlds.
  Trajectory trajectory;
  std::vector<int> frames;
  std::vector<int> segments;

  int lost = 0;  // number of frames without a pose

  // Turns the world into the axes of a level camera, x right, y down, z ahead,
  // for viewers and ROS. The identity if gravity is not known: the first camera
  // is taken for level.
  Rigid3d level_from_world;
};

// The largest connected part of a map: the frames are its keyframes, numbered
// by their ids. If two of them have the same stamp, as a map that several
// recordings have made may have, stamps are counted from 0 s, a second apart. A
// map does not keep the noise of depth: that of an unknown camera is taken.
// Throws InputError for a folder without a map, and for an empty or damaged
// one.
FinishedRun MapAsRun(const std::string& folder);

// As FinishedRun::level_from_world, from the direction of up in the world.
Rigid3d LevelFromWorld(const Eigen::Vector3d& up);

// User options of an export. Each format uses the options that concern it.
struct ExportOptions {
  std::string output;      // file or folder, depending on the format
  bool overwrite = false;  // replaces an existing folder

  // Selects the exported frames for formats with images.
  MotionFilter step;

  bool undistort = false;   // images, to a pinhole camera
  double voxel = 0.01;      // of meshes and clouds, m
  double max_depth = 0.0;   // for these, m; 0: that of the run (meshes: 4 m)
  int max_points = 200000;  // of clouds exported with images
  int threads = 1;          // that read images in advance

  // Called after each frame that was read, in place of a progress bar. It may
  // throw, which ends the export.
  std::function<void()> on_frame;
};

// The upper left pixel's centre for COLMAP and nerfstudio; here it is at 0.
constexpr double kPixelCentre = 0.5;

// An export format for other tools, a row of the table in export_format.cc.
struct ExportFormat {
  const char* name;            // name for users
  const char* default_output;  // file or folder, in that of the run
  // Writes all or nothing and returns the text to print. Throws InputError.
  std::string (*write)(const FinishedRun& run, const ExportOptions& options);
};

// Poses only.
std::string ExportTum(const FinishedRun& run, const ExportOptions& options);
std::string ExportKitti(const FinishedRun& run, const ExportOptions& options);
std::string ExportG2o(const FinishedRun& run, const ExportOptions& options);

// Images with poses.
std::string ExportColmap(const FinishedRun& run, const ExportOptions& options);
std::string ExportNerfstudio(const FinishedRun& run,
                             const ExportOptions& options);
std::string ExportMcap(const FinishedRun& run, const ExportOptions& options);

std::string ExportCloud(const FinishedRun& run, const ExportOptions& options);
std::string ExportMesh(const FinishedRun& run, const ExportOptions& options);

const std::vector<ExportFormat>& ExportFormats();

// Opens a run's recording, with colour. Throws InputError if missing or broken.
std::unique_ptr<FrameSource> OpenRecording(const FinishedRun& run);

// Called for a frame of a run; `view` is the index of its pose.
using OnView = std::function<void(const Frame& frame, int view)>;

// Reads the frames of the first segment that options.step selects. Call it once
// for an opened recording. Returns the indices of their poses in the
// trajectory. Throws InputError if a frame is missing or unreadable.
std::vector<int> ReadViews(const FinishedRun& run, const ExportOptions& options,
                           FrameSource* source, const OnView& on_view);

// The views of a run in an export with images, and the points seen in them.
struct ExportedViews {
  Camera camera;           // of the exported images
  std::vector<int> views;  // indices in the run's trajectory
  std::vector<ColoredPoint> cloud;
};

// Calls `on_image` for each view, in order, with the image to export.
ExportedViews ReadImages(const FinishedRun& run, const ExportOptions& options,
                         const OnView& on_image);

// Depth in whole millimetres (CV_16UC1), 0 where it is missing or too large.
cv::Mat DepthInMillimetres(const Frame& frame);

// The file name of the image of a view, by its frame number.
std::string ImageName(const FinishedRun& run, int view);

// Writes the images as files of these names. With a folder for them, depth
// images are written as by DepthInMillimetres.
ExportedViews WriteViewImages(const FinishedRun& run,
                              const ExportOptions& options,
                              const std::filesystem::path& color_folder,
                              const std::filesystem::path& depth_folder = {});

// Settings for fusing the views to a cloud or a mesh, with the depth noise that
// tracking had. `camera` is that of the recording. Throws InputError.
template <typename Fusion>
Fusion FusionOf(const RgbdCamera& camera, const FinishedRun& run,
                const ExportOptions& options, Fusion fusion = {}) {
  fusion.camera = camera.camera;
  fusion.voxel_size = options.voxel;
  fusion.depth = FeaturesFor(run.odometry, camera).depth;
  if (options.max_depth > 0.0) fusion.depth.max_depth = options.max_depth;
  RequireSound(fusion.Check(), "--voxel or --max_depth: ");
  return fusion;
}

// A folder that is written next to its place and moved there when complete.
class OutputFolder {
 public:
  // Throws InputError if the folder cannot be created, is in use, or is not
  // empty: then `overwrite` must be set and an export have written all in it.
  OutputFolder(const std::string& path, bool overwrite);

  // Creates a folder inside the staging folder and returns its current path.
  std::filesystem::path MakeFolder(const std::string& name) const;

  const std::filesystem::path& staging_dir() const { return staging_.path(); }

  // Moves the folder to its place, with a list of its files.
  void Publish();

 private:
  const std::filesystem::path path_;
  const std::filesystem::path replaced_dir_;  // where an old folder waits
  const LockedFolder staging_;
};

}  // namespace rgbd_pose
