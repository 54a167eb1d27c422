// Exports poses: TUM, KITTI, g2o.

#include <algorithm>

#include "apps/export/export_format.h"
#include "apps/results/frame_tables.h"
#include "apps/results/slam_output.h"
#include "core/util/format.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

int Count(std::string_view word, std::string_view text) {
  int count = 0;
  for (size_t at = 0; (at = text.find(word, at)) != text.npos; ++at) ++count;
  return count;
}

// What users should know of poses that are not in the world of the first one.
std::string OtherWorlds(const FinishedRun& run) {
  const auto others =
      std::count_if(run.segments.begin(), run.segments.end(),
                    [&run](int segment) { return segment != run.segments[0]; });
  if (others == 0) return "";
  return Format(
      "%d of the poses are of other segments: their position relative to the "
      "first segment is unknown\n",
      static_cast<int>(others));
}

// The motions measured by rgbd_odometry, as a graph of all frames with a pose.
KeyframeMap GraphOfFrames(const FinishedRun& run) {
  KeyframeMap graph;
  const std::set<int> posed(run.frames.begin(), run.frames.end());
  for (size_t i = 0; i < run.frames.size(); ++i) {
    graph.keyframes.push_back(
        {run.frames[i], run.segments[i], run.trajectory[i].world_from_cam});
  }
  for (const RelativePose& edge : ReadEdges(run.folder)) {
    if (posed.count(edge.ref) != 0 && posed.count(edge.cur) != 0) {
      graph.edges.push_back({edge});
    }
  }
  return graph;
}

std::string GraphAsText(const FinishedRun& run) {
  if (run.map != nullptr) return FormatG2o(*run.map);
  if (run.folder.empty()) {
    throw InputError(
        "g2o: a path alone has no measured motions; export the folder of a run "
        "of rgbd_odometry or rgbd_slam");
  }
  const std::filesystem::path solved =
      std::filesystem::path(run.folder) / "graph.g2o";
  return std::filesystem::exists(solved) ? ReadTextFile(solved.string())
                                         : FormatG2o(GraphOfFrames(run));
}

}  // namespace

std::string ExportTum(const FinishedRun& run, const ExportOptions& options) {
  WriteFileAtomically(options.output, FormatTrajectory(run.trajectory));
  return Format("%zu poses in %s\n", run.trajectory.size(),
                options.output.c_str()) +
         OtherWorlds(run);
}

// Writes one line per pose, the upper rows of world_from_cam, and a file of
// times.
std::string ExportKitti(const FinishedRun& run, const ExportOptions& options) {
  OutputFolder folder(options.output, options.overwrite);
  std::string poses, times;
  for (const StampedPose& pose : run.trajectory) {
    const Eigen::Matrix3d R = pose.world_from_cam.rotation.toRotationMatrix();
    for (int i = 0; i < 3; ++i) {
      poses += Format("%s%.9g %.9g %.9g %.9g", i > 0 ? " " : "", R(i, 0),
                      R(i, 1), R(i, 2), pose.world_from_cam.translation[i]);
    }
    poses += "\n";
    times += Format("%.6f\n", pose.timestamp - run.trajectory[0].timestamp);
  }
  WriteFileAtomically(folder.staging_dir() / "poses.txt", poses);
  WriteFileAtomically(folder.staging_dir() / "times.txt", times);
  folder.Publish();
  std::string text = Format("%zu poses in %s\n", run.trajectory.size(),
                            options.output.c_str());
  if (run.lost > 0) {
    text += std::to_string(run.lost) +
            " frames have no pose and therefore no line: line numbers are not "
            "frame numbers; see times.txt\n";
  }
  return text + OtherWorlds(run);
}

std::string ExportG2o(const FinishedRun& run, const ExportOptions& options) {
  const std::string text = GraphAsText(run);
  WriteFileAtomically(options.output, text);
  return Format("%d vertices, %d edges in %s\n", Count("VERTEX_", text),
                Count("EDGE_", text), options.output.c_str());
}

}  // namespace rgbd_pose
