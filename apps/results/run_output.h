#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/odometry_run.h"
#include "apps/pipeline/settings.h"
#include "apps/results/run_folder.h"
#include "frontend/fusion/cloud_fusion.h"
#include "frontend/sources/frame_range.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// What a run of rgbd_odometry is to leave behind, by the names of its flags.
struct RunOutputSettings {
  std::string output;        // folder
  std::string debug_images;  // FrameSelection
  std::string save_cloud;    // file; empty: no cloud
  std::string save_mesh;     // file; empty: no mesh
  double voxel = 0.01;       // side of the cubes of both, m
};

// Their rows.
std::vector<Setting> SettingTable(RunOutputSettings* settings);

// The files of a run: drawn and fused as frames come, written at the end.
class RunOutput {
 public:
  // Makes what must be there before the work begins. Throws InputError if it
  // cannot, or for options that make no sense. The source must outlive it and
  // keep colours for a cloud.
  RunOutput(const RunOutputSettings& settings, const FrameSource& source,
            const DepthLookupOptions& depth);

  // After the run has tracked a frame.
  void Add(const Frame& frame, const SequenceRun& run);

  // Where its files are written, and further ones may be.
  RunFolder& folder() { return folder_; }

  // Writes all files but the page: `flags` into config.flags, `dataset`, the
  // program's name and `more` (an object) into metrics.json. `seconds`: of the
  // whole program, up to the last frame, by `threads`. `truth` may be null.
  // Returns what the program prints of them.
  std::string Write(const RunResults& results, int threads, double seconds,
                    const Trajectory* truth, const std::string& dataset,
                    const std::string& flags,
                    const std::string& program = "rgbd_odometry",
                    const nlohmann::json& more = nullptr);

 private:
  nlohmann::json DepthStampsToJson() const;
  nlohmann::json WriteCloud(const Rigid3d& shown_from_world,
                            std::string* text) const;

  RunOutputSettings settings_;
  const FrameSource& source_;
  FrameSelection drawn_;
  FusionOptions cloud_options_;
  std::optional<CloudFusion> cloud_;
  RunFolder folder_;
  std::vector<double> depth_stamps_ms_;  // of each frame, after colour's
};

}  // namespace rgbd_pose
