#include "apps/compare_sequence.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <optional>

#include "apps/progress_bar.h"
#include "apps/svg_chart.h"
#include "core/input_error.h"
#include "core/pose_pairs.h"
#include "frontend/frame_stream.h"

namespace rgbd_pose {
namespace {

constexpr double kDegrees = 180.0 / M_PI;
constexpr double kMillimetres = 1e3;

// The last pose of a run seen from its first, in the thesis' parameters.
struct EndPose {
  Eigen::Vector3d angles_deg;  // alpha, beta, gamma of R = Rz Ry Rx
  Eigen::Vector3d centre_mm;   // C
};

EndPose EndPoseOf(const Trajectory& trajectory) {
  const Rigid3d first_from_last = trajectory.front().world_from_cam.Inverse() *
                                  trajectory.back().world_from_cam;
  const Eigen::Matrix3d R =
      first_from_last.rotation.conjugate().toRotationMatrix();
  return {kDegrees * Eigen::Vector3d(
                         std::atan2(R(2, 1), R(2, 2)),
                         std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0))),
                         std::atan2(R(1, 0), R(0, 0))),
          kMillimetres * first_from_last.translation};
}

// The path (x, y or z by `row` over x) with its first paired pose laid on the
// truth's.
ChartSeries PathSeries(const LossRun& run, const Trajectory& truth, int row) {
  const std::vector<PosePair> pairs =
      PairPoses(run.trajectory, truth, run.report.options.max_time_difference);
  const Rigid3d truth_from_run =
      pairs.front().truth * pairs.front().estimate.Inverse();
  ChartSeries series;
  series.label = run.loss;
  for (const StampedPose& pose : run.trajectory) {
    const Eigen::Vector3d p = truth_from_run * pose.world_from_cam.translation;
    series.points.push_back({p.x(), p(row)});
  }
  return series;
}

template <typename... Values>
std::string Row(const char* format, Values... values) {
  char text[512];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

}  // namespace

std::vector<LossRun> CompareLosses(const Dataset& dataset,
                                   const Trajectory& truth,
                                   const std::vector<std::string>& losses,
                                   const OdometrySettings& settings,
                                   int threads) {
  std::vector<Odometry> odometries;
  for (const std::string& loss : losses) {
    OdometrySettings own = settings;
    own.loss = loss;
    odometries.push_back(MakeOdometry(own, dataset.camera().camera));
  }
  std::vector<std::vector<TrackedFrame>> frames(losses.size());
  {
    ProgressBar bar("tracking", dataset.size());
    FrameStream stream(dataset, &odometries[0].frontend(), threads);
    for (int i = 0; i < dataset.size(); ++i) {
      const StreamedFrame next = stream.Next();
      for (size_t k = 0; k < losses.size(); ++k) {
        frames[k].push_back(odometries[k].Track(next.frame));
      }
      bar.Update(i + 1);
    }
  }
  std::vector<LossRun> runs;
  for (size_t k = 0; k < losses.size(); ++k) {
    LossRun run;
    run.loss = losses[k];
    run.trajectory = TrackedTrajectory(frames[k]);
    run.tracked_share =
        static_cast<double>(run.trajectory.size()) / dataset.size();
    if (run.trajectory.empty()) {
      throw InputError("no frame could be tracked with the loss " + run.loss +
                       "; rgbd_odometry says why");
    }
    run.report = Evaluate(run.trajectory, truth, {});
    runs.push_back(run);
  }
  return runs;
}

std::string EndPoseTable(const std::vector<LossRun>& runs) {
  std::string text =
      "| loss | alpha (deg) | beta (deg) | gamma (deg) | Cx (mm) | Cy (mm) | "
      "Cz (mm) | angle (deg) | distance (mm) |\n"
      "|---|---:|---:|---:|---:|---:|---:|---:|---:|\n"
      "| truth | 0 | 0 | 0 | 0 | 0 | 0 | 0 | 0 |\n";
  for (const LossRun& run : runs) {
    const EndPose end = EndPoseOf(run.trajectory);
    const FinalPoseError error =
        run.report.final_pose.value_or(FinalPoseError{});
    text +=
        Row("| %s | %.4f | %.4f | %.4f | %.3f | %.3f | %.3f | %.4f | %.3f |\n",
            run.loss.c_str(), end.angles_deg.x(), end.angles_deg.y(),
            end.angles_deg.z(), end.centre_mm.x(), end.centre_mm.y(),
            end.centre_mm.z(), error.angle * kDegrees,
            error.translation * kMillimetres);
  }
  return text;
}

std::string PathErrorTable(const std::vector<LossRun>& runs) {
  std::string text =
      "| loss | ATE (mm) | RPE over 1 s (mm) | RPE over 1 s (deg) | end (mm) | "
      "end (deg) | tracked (%) |\n"
      "|---|---:|---:|---:|---:|---:|---:|\n";
  for (const LossRun& run : runs) {
    const FinalPoseError end = run.report.final_pose.value_or(FinalPoseError{});
    text += Row("| %s | %.3f | %.3f | %.4f | %.3f | %.4f | %.1f |\n",
                run.loss.c_str(), run.report.ate.rmse * kMillimetres,
                run.report.rpe_seconds.translation.rmse * kMillimetres,
                run.report.rpe_seconds.rotation.rmse * kDegrees,
                end.translation * kMillimetres, end.angle * kDegrees,
                run.tracked_share * 100.0);
  }
  return text;
}

std::string PathFigure(const std::string& title,
                       const std::vector<LossRun>& runs,
                       const Trajectory& truth) {
  Chart chart;
  chart.title = title;
  chart.same_scale = true;
  for (const int row : {1, 2}) {
    ChartPanel panel;
    panel.title = row == 1 ? "X-Y" : "X-Z";
    panel.x_label = "X (m)";
    panel.y_label = row == 1 ? "Y (m)" : "Z (m)";
    ChartSeries true_path{"truth", "#999999", false, 5.0, {}};
    for (const PosePair& pair :
         PairPoses(runs[0].trajectory, truth,
                   runs[0].report.options.max_time_difference)) {
      const Eigen::Vector3d p = pair.truth.translation;
      true_path.points.push_back({p.x(), p(row)});
    }
    panel.series.push_back(true_path);
    for (size_t k = 0; k < runs.size(); ++k) {
      ChartSeries series = PathSeries(runs[k], truth, row);
      series.colour = SeriesColour(static_cast<int>(k));
      series.is_dashed = k >= kNumSeriesColours;
      series.width_px = 1.2;
      panel.series.push_back(series);
    }
    chart.panels.push_back(panel);
  }
  return FormatSvg(chart);
}

const char kSequenceCsvHeader[] =
    "sequence,loss,alpha_deg,beta_deg,gamma_deg,cx_mm,cy_mm,cz_mm,end_deg,"
    "end_mm,ate_mm,rpe_seconds_mm,rpe_seconds_deg,tracked_share\n";

std::string SequenceCsvRows(const std::string& name,
                            const std::vector<LossRun>& runs) {
  std::string text;
  for (const LossRun& run : runs) {
    const EndPose end = EndPoseOf(run.trajectory);
    const FinalPoseError error =
        run.report.final_pose.value_or(FinalPoseError{});
    text += "\"" + name + "\"," + run.loss;
    for (const double value :
         {end.angles_deg.x(), end.angles_deg.y(), end.angles_deg.z(),
          end.centre_mm.x(), end.centre_mm.y(), end.centre_mm.z(),
          error.angle * kDegrees, error.translation * kMillimetres,
          run.report.ate.rmse * kMillimetres,
          run.report.rpe_seconds.translation.rmse * kMillimetres,
          run.report.rpe_seconds.rotation.rmse * kDegrees, run.tracked_share}) {
      text += Row(",%.6g", value);
    }
    text += "\n";
  }
  return text;
}

}  // namespace rgbd_pose
