#include "apps/results/frame_tables.h"

#include <algorithm>
#include <cmath>

#include "apps/shell/csv_table.h"
#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

const std::string kEdgeColumns =
    std::string("ref,cur,tx,ty,tz,qx,qy,qz,qw") + kCovarianceColumns;

}  // namespace

std::string FormatPose(const Rigid3d& pose, char separator) {
  Eigen::Matrix<double, 7, 1> values;
  values << pose.translation, pose.rotation.coeffs();
  std::string text;
  for (const double value : values) text += separator + Format("%.9g", value);
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
    // Reasons are fixed texts, which contain no quotes.
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
  std::string text = kEdgeColumns + "\n";
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
  std::vector<std::vector<double>> columns;
  for (const std::string& name : SplitText(kEdgeColumns, ',')) {
    columns.push_back(table.Numbers(name));
  }
  std::vector<RelativePose> edges;
  for (size_t row = 0; row < table.size(); ++row) {
    auto column = columns.begin();
    const auto next = [&] { return (*column++)[row]; };
    RelativePose& edge = edges.emplace_back();
    edge.ref = static_cast<int>(next());
    edge.cur = static_cast<int>(next());
    const double tx = next(), ty = next(), tz = next();
    const double qx = next(), qy = next(), qz = next(), qw = next();
    edge.cur_from_ref = Rigid3d({qw, qx, qy, qz}, {tx, ty, tz});
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) {
        edge.covariance(i, j) = edge.covariance(j, i) = next();
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
    // A keyframe of a loaded map has a number below 0.
    if (edge.cur < 0 || std::max(edge.ref, edge.cur) >= size) {
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
                            const Trajectory& path, const Trajectory& truth,
                            const EvaluationReport& report) {
  std::string text =
      "timestamp,true_x,true_y,true_z,x,y,z,position_error_m,rpe_m,rpe_deg\n";
  const std::vector<double> times = TimesOf(truth);
  auto pose = path.begin();
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
          report.truth_from_estimate * (pose++)->world_from_cam.translation;
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
