#include "frontend/slam/sequence_run.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/util/input_error.h"

namespace rgbd_pose {

void SequenceRun::Add(const StreamedFrame& next) {
  const std::vector<TrackedFrame>& frames = results_.frames;
  std::optional<Rigid3d> guess;
  if (inputs_.motion_guess != nullptr && !frames.empty()) {
    guess = MotionAlong(*inputs_.motion_guess, frames.back().timestamp,
                        next.frame.timestamp);
  }
  AddImu(next.imu);
  Add(next.frame, guess.has_value() ? &*guess : nullptr);
  results_.frames.back().decode_ms = next.decode_ms;
}

void SequenceRun::Add(const PreparedFrame& frame,
                      const Rigid3d* cur_from_prev_guess) {
  std::vector<TrackedFrame>& frames = results_.frames;
  frames.push_back(Track(frame, cur_from_prev_guess));
  const TrackedFrame& tracked = frames.back();
  if (tracked.previous_is_reference) {
    frames[frames.size() - 2].is_reference = true;
  }
  if (tracked.status != TrackingStatus::kLost && tracked.matches > 0) {
    results_.residuals.Add(odometry().last_estimate());
  }
}

void SequenceRun::UseImu(const ImuSensor& sensor) {
  if (slam_ != nullptr) {
    slam_->UseImu(sensor);
    return;
  }
  meter_.emplace(sensor);
  odometry_->UseImu(sensor);
}

void SequenceRun::AddImu(const std::vector<ImuSample>& samples) {
  if (slam_ != nullptr) {
    slam_->AddImu(samples);
  } else if (meter_.has_value()) {
    meter_->Add(samples);
    odometry_->AddImu(samples);
  }
}

RunResults SequenceRun::Finish(const Trajectory* ground_truth) {
  if (slam_ != nullptr) FinishSlam();
  results_.trajectory = Path();
  results_.repeated = odometry().repeated();
  if (meter_.has_value()) meter_->CorrectBy(odometry().imu());
  results_.gravity = Gravity();
  if (odometry().imu() != nullptr) results_.imu = *odometry().imu();
  if (ground_truth != nullptr && !results_.trajectory.empty()) {
    try {
      results_.evaluation = Evaluate(results_.trajectory, *ground_truth);
      results_.evaluation->consistency =
          JudgeFrames(results_.frames, *ground_truth, inputs_.truth_noise,
                      results_.evaluation->truth_alignment);
    } catch (const InputError& error) {
      results_.no_evaluation = error.what();
    }
  }
  return std::move(results_);
}

void SequenceRun::FinishSlam() {
  slam_->Finish();
  const Rigid3d& upright_from_tracked = slam_->upright_from_tracked();
  if (upright_from_tracked.IsIdentity()) return;
  for (SlamFrame& frame : slam_frames_) {
    frame.map_from_odom = upright_from_tracked * frame.map_from_odom;
  }
  for (TrackedFrame& frame : results_.frames) {
    frame.world_from_cam = upright_from_tracked * frame.world_from_cam;
  }
}

std::optional<GravityEstimate> SequenceRun::Gravity() const {
  if (slam_ != nullptr) return slam_->gravity();
  if (!meter_.has_value()) return std::nullopt;
  std::map<int, Trajectory> paths;
  for (const TrackedFrame& frame : results_.frames) {
    if (frame.status == TrackingStatus::kLost) continue;
    paths[frame.segment].push_back({frame.timestamp, frame.world_from_cam});
  }
  return EstimateGravity(*meter_, paths);
}

Trajectory SequenceRun::Path() const {
  if (slam_ != nullptr) return slam_->Path();
  Trajectory path;
  for (const TrackedFrame& frame : results_.frames) {
    if (frame.status == TrackingStatus::kLost) continue;
    path.push_back({frame.timestamp, frame.world_from_cam});
  }
  return path;
}

std::string TrackAll(FrameSource* source, int threads,
                     const std::vector<SequenceRun*>& runs,
                     const std::function<bool(const Frame& frame)>& on_frame) {
  const Odometry& first = runs.front()->odometry();
  FrameStream stream(
      source, [&first](const PreparedFrame& frame) { first.Prepare(frame); },
      threads, runs.front()->inputs().max_damaged);
  while (const std::optional<StreamedFrame> next = stream.Next()) {
    for (SequenceRun* run : runs) run->Add(*next);
    if (on_frame && !on_frame(next->frame)) break;
  }
  for (SequenceRun* run : runs) run->SetDamaged(stream.damaged());
  return stream.stopped();
}

RunConsistency JudgeFrames(const std::vector<TrackedFrame>& frames,
                           const Trajectory& truth, const TruthNoise& noise,
                           const TruthAlignment& alignment) {
  RunConsistency result;
  result.truth_noise = noise;
  std::vector<double> times;
  std::vector<RelativePose> ok_edges, edges;
  for (const TrackedFrame& frame : frames) {
    times.push_back(frame.timestamp);
    edges.insert(edges.end(), frame.edges.begin(), frame.edges.end());
    if (frame.status != TrackingStatus::kOk) continue;
    ++result.ok;
    if (!frame.edges.empty()) ok_edges.push_back(frame.edges.front());
  }
  result.ok_frames = Judge(ok_edges, times, truth, noise);
  result.edges = Judge(edges, times, truth, noise);
  if (alignment.skipped.empty()) {
    for (double& time : times) time += alignment.fixing.shift;
    result.in_time = Judge(ok_edges, times, truth, noise);
  }
  return result;
}

void ResidualHistogram::Add(const MotionEstimate& estimate) {
  for (size_t i = 0; i < estimate.residual_norms.size(); ++i) {
    const int count = estimate.residual_degrees[i];
    if (count == 0) continue;
    ++matches;
    ++degrees[std::min<size_t>(count, degrees.size() - 1)];
    // The comparison comes before the conversion, because a huge norm does not
    // fit into an index.
    const double place = estimate.residual_norms[i] / kNormBin;
    if (place < norms.size()) {
      ++norms[static_cast<size_t>(place)];
    } else {
      ++norms_above;
    }
    const double weight = estimate.weights[i];
    weights_zero += weight == 0.0;
    ++weights[std::min(static_cast<size_t>(weight / kWeightBin),
                       weights.size() - 1)];
  }
}

TrackedFrame SequenceRun::Track(const PreparedFrame& frame,
                                const Rigid3d* cur_from_prev_guess) {
  if (slam_ == nullptr) return odometry_->Track(frame, cur_from_prev_guess);
  SlamFrame in_map = slam_->Track(frame, cur_from_prev_guess);
  if (in_map.tracked.previous_is_reference) {
    slam_frames_.back().tracked.is_reference = true;
  }
  TrackedFrame tracked = in_map.tracked;
  tracked.world_from_cam = in_map.map_from_cam();
  tracked.segment = in_map.segment;
  // Edges are kept only once, because those of a long recording take much
  // memory.
  in_map.tracked.edges = {};
  slam_frames_.push_back(std::move(in_map));
  return tracked;
}

}  // namespace rgbd_pose
