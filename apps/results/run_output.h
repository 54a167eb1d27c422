#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "apps/results/run_folder.h"
#include "apps/shell/program.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/stamp_jitter.h"
#include "frontend/settings/settings.h"
#include "frontend/slam/sequence_run.h"
#include "frontend/sources/frame_range.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// The outputs of a run of rgbd_odometry, named like its flags.
struct RunOutputSettings {
  std::string output;        // folder
  std::string debug_images;  // FrameSelection
  std::string save_cloud;    // file; empty: no cloud
  std::string save_mesh;     // file; empty: no mesh
  std::string record;        // file; empty: no recording
  double voxel = 0.01;       // side of the voxels of both, m
};

std::vector<Setting> SettingTable(RunOutputSettings* settings);

// The output files of a run; images are drawn as frames arrive.
class RunOutput {
 public:
  // Creates the output folder before the run. Throws InputError if this fails
  // or for invalid options, also those of the odometry for clouds and meshes.
  // The source must outlive this object.
  RunOutput(const RunOutputSettings& settings, const FrameSource& source,
            const OdometrySettings& odometry);

  // Warns if --debug_images names a frame that a recording of so many frames
  // does not have.
  void WarnOfMissingImages(size_t frames) const;

  // Call after the run has tracked a frame.
  void Add(const Frame& frame, const SequenceRun& run);

  // The folder of the files; callers may add further files.
  RunFolder& folder() { return folder_; }

  // Writes all files except the page, and warns of what the errors of the run
  // suggest about its input. The flags go into config.flags; `dataset`, the
  // program's name and `more` (an object) go into metrics.json. `seconds` is
  // the time of the whole program up to the last frame, with `threads` threads.
  // `truth` may be null. Returns the text to print.
  std::string Write(const RunResults& results, int threads, double seconds,
                    const Trajectory* truth, const std::string& dataset,
                    const ProgramInfo& info, const nlohmann::json& more);

 private:
  const FrameSource& source_;
  FrameSelection drawn_;
  RunFolder folder_;
  std::vector<double> depth_stamps_ms_;  // relative to colour, per frame
  StampJitter stamp_jitter_;             // of these
  std::vector<double> jitters_ms_;       // its standard deviation, per frame
};

}  // namespace rgbd_pose
