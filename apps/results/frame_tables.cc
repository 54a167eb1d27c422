#include "apps/results/frame_tables.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/shell/csv_table.h"
#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "core/util/units.h"

namespace rgbd_pose {
const char kCovarianceColumns[] =
    ",cov_wx_wx,cov_wx_wy,cov_wx_wz,cov_wx_cx,cov_wx_cy,cov_wx_cz,cov_wy_wy"
    ",cov_wy_wz,cov_wy_cx,cov_wy_cy,cov_wy_cz,cov_wz_wz,cov_wz_cx,cov_wz_cy"
    ",cov_wz_cz,cov_cx_cx,cov_cx_cy,cov_cx_cz,cov_cy_cy,cov_cy_cz,cov_cz_cz";

std::string FormatPose(const Rigid3d& pose, char separator) {
  std::string text;
  for (const double value : pose.translation) {
    text += separator + Format("%.9g", value);
  }
  for (const double value : pose.rotation.coeffs()) {
    text += separator + Format("%.9g", value);
  }
  return text;
}

std::string FormatTriangle(const MotionMatrix& matrix, char separator) {
  std::string text;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j)
      text += separator + Format("%.9g", matrix(i, j));
  }
  return text;
}

std::string FormatFramesCsv(const std::vector<TrackedFrame>& frames) {
  std::string text =
      "timestamp,status,reason,segment,reference,is_reference,relocalised,"
      "predicted,tracking_source,matches,inliers,iterations,sigma,"
      "tx,ty,tz,qx,qy,qz,qw,"
      "decode_ms,track_ms,match_ms,solve_ms,reference_ms,relocalise_ms\n";
  for (const TrackedFrame& frame : frames) {
    // Reasons are fixed texts without quotes.
    text +=
        Format("%.6f,%s,\"%s\",%d,%d,%d,%d,%d,%s,%d,%d,%d,%.4f",
               frame.timestamp, ToString(frame.status), frame.reason.c_str(),
               frame.segment, frame.reference, frame.is_reference,
               frame.relocalised, frame.is_predicted, ToString(frame.source),
               frame.matches, frame.inliers, frame.iterations, frame.sigma);
    text += FormatPose(frame.world_from_cam);
    for (const double ms :
         {frame.decode_ms, frame.track_ms, frame.match_ms, frame.solve_ms,
          frame.reference_ms, frame.relocalise_ms}) {
      text += Format(",%.3f", ms);
    }
    text += "\n";
  }
  return text;
}

std::string FormatEdgesCsv(const std::vector<TrackedFrame>& frames) {
  std::string text =
      std::string("ref,cur,tx,ty,tz,qx,qy,qz,qw") + kCovarianceColumns + "\n";
  for (const TrackedFrame& frame : frames) {
    for (const RelativePose& edge : frame.edges) {
      text += Format("%d,%d", edge.ref, edge.cur) +
              FormatPose(edge.cur_from_ref) + FormatTriangle(edge.covariance) +
              "\n";
    }
  }
  return text;
}

std::vector<RelativePose> ReadEdges(const std::filesystem::path& folder) {
  const CsvTable table = CsvTable::Read(folder / "edges.csv");
  const std::vector<double> ref = table.Numbers("ref");
  const std::vector<double> cur = table.Numbers("cur");
  std::vector<std::vector<double>> pose, covariance;
  for (const char* name : {"tx", "ty", "tz", "qx", "qy", "qz", "qw"}) {
    pose.push_back(table.Numbers(name));
  }
  for (const std::string& name : SplitText(kCovarianceColumns + 1, ',')) {
    covariance.push_back(table.Numbers(name));
  }
  std::vector<RelativePose> edges(table.size());
  for (size_t row = 0; row < table.size(); ++row) {
    RelativePose& edge = edges[row];
    edge.ref = static_cast<int>(ref[row]);
    edge.cur = static_cast<int>(cur[row]);
    edge.cur_from_ref = Rigid3d(Eigen::Quaterniond(pose[6][row], pose[3][row],
                                                   pose[4][row], pose[5][row]),
                                {pose[0][row], pose[1][row], pose[2][row]});
    size_t at = 0;
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j, ++at) {
        edge.covariance(i, j) = edge.covariance(j, i) = covariance[at][row];
      }
    }
  }
  return edges;
}

std::vector<TrackedFrame> ReadFrames(const std::filesystem::path& folder) {
  const CsvTable table = CsvTable::Read(folder / "frames.csv");
  const std::vector<double> times = table.Numbers("timestamp");
  const std::vector<std::string> status = table.Words("status");
  std::vector<TrackedFrame> frames(table.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    frames[i].index = static_cast<int>(i);
    frames[i].timestamp = times[i];
    for (const TrackingStatus known :
         {TrackingStatus::kOk, TrackingStatus::kDegraded}) {
      if (status[i] == ToString(known)) frames[i].status = known;
    }
  }
  const int size = static_cast<int>(frames.size());
  for (const RelativePose& edge : ReadEdges(folder)) {
    if (std::min(edge.ref, edge.cur) < 0 ||
        std::max(edge.ref, edge.cur) >= size) {
      throw InputError((folder / "edges.csv").string() + ": the motion from " +
                       std::to_string(edge.ref) + " to " +
                       std::to_string(edge.cur) +
                       " is not between frames of frames.csv; repeat the run");
    }
    frames[edge.cur].edges.push_back(edge);
  }
  return frames;
}

std::string FormatErrorsCsv(const std::vector<TrackedFrame>& frames,
                            const Trajectory& truth,
                            const EvaluationReport& report) {
  std::string text =
      "timestamp,true_x,true_y,true_z,x,y,z,position_error_m,rpe_m,rpe_deg\n";
  std::vector<double> times;
  times.reserve(truth.size());
  for (const StampedPose& pose : truth) times.push_back(pose.timestamp);
  auto error = report.poses.begin();
  for (const TrackedFrame& frame : frames) {
    // NaN stands for an unknown value.
    Eigen::Matrix<double, 9, 1> cells = decltype(cells)::Constant(NAN);
    const size_t nearest = NearestTime(times, frame.timestamp);
    if (std::abs(times[nearest] - frame.timestamp) <=
        report.options.max_time_difference) {
      cells.head<3>() = truth[nearest].world_from_cam.translation;
    }
    if (frame.status != TrackingStatus::kLost) {
      cells.segment<3>(3) =
          report.truth_from_estimate * frame.world_from_cam.translation;
      if (error != report.poses.end() && error->timestamp == frame.timestamp) {
        cells[6] = error->position;
        cells[7] = error->rpe_translation.value_or(NAN);
        cells[8] = error->rpe_rotation.value_or(NAN) * kDegreesPerRadian;
        ++error;
      }
    }
    text += Format("%.6f", frame.timestamp);
    for (const double cell : cells) {
      text += std::isnan(cell) ? "," : Format(",%.6f", cell);
    }
    text += "\n";
  }
  return text;
}

}  // namespace rgbd_pose
