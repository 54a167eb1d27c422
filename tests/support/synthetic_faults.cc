#include "tests/support/synthetic_faults.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "core/util/input_error.h"
#include "frontend/simulation/synthetic_hash.h"
#include "frontend/simulation/synthetic_scene.h"
#include "frontend/simulation/synthetic_sensor.h"

namespace rgbd_pose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kThinning = 3;

const Vector3d kBoxSize(0.62, 0.20, 0.46);  // width, depth, height (m)
constexpr double kBoxFront = 0.8;           // m
constexpr double kBoxRadius = 0.1;        // m, radius of the circle it moves on
constexpr double kBoxSpeed = 0.3;         // m/s
constexpr uint64_t kBoxNoise = 0x626f78;  // seed that separates its noise

// In axes of its own: x along its width, z up, from its centre.
Scene MakeBox(uint32_t seed) {
  Material print;
  print.color = {0.45f, 0.55f, 0.62f};
  print.tile = {0.09f, 0.07f};
  print.tile_contrast = 0.2f;
  print.tile_tint = 0.15f;
  print.glyph = 0.008f;
  print.glyph_density = 0.4f;
  Scene scene = {{}, {0.3, -1.5, 1.0}, seed};
  AddBox({{0.0, 0.0, -kBoxSize.z() / 2.0}, kBoxSize, 0.0}, false,
         {print, print, print, print, print, print}, &scene);
  return scene;
}

SyntheticOptions Turned(SyntheticOptions options) {
  const Rigid3d turn(
      Quaterniond(AngleAxisd(kFaultTurnDeg * M_PI / 180.0, Vector3d::UnitY())),
      Vector3d::Zero());
  options.path_from_cam = options.path_from_cam.value_or(Rigid3d()) * turn;
  return options;
}

// The box `t` seconds after it appears, in axes of the camera at that frame.
Rigid3d FirstCamFromBox(double t) {
  const double angle = kBoxSpeed / kBoxRadius * t;
  const Vector3d centre(kBoxRadius * std::cos(angle),
                        kBoxRadius * std::sin(angle),
                        kBoxFront + kBoxSize.y() / 2.0);
  Eigen::Matrix3d upright;  // right, forward, up to right, down, forward
  upright << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return Rigid3d(Quaterniond(upright), centre);
}

bool Affects(const Fault& fault, int source_index) {
  return source_index >= fault.first && source_index < fault.end;
}

void Check(const Fault& fault, int frames) {
  if (fault.first < 0 || fault.first >= frames || fault.end <= fault.first) {
    throw InputError("a fault of the frames from " +
                     std::to_string(fault.first) + " to before " +
                     std::to_string(fault.end) + " touches none of 0.." +
                     std::to_string(frames - 1));
  }
  if (!(fault.gain >= 0.0)) {
    throw InputError("the gain of a fault must not be negative");
  }
}

}  // namespace

FaultyDataset::FaultyDataset(const SyntheticOptions& options,
                             std::vector<Fault> faults)
    : options_(options),
      faults_(std::move(faults)),
      sound_(options),
      turned_(Turned(options)),
      box_renderer_(MakeBox(options.seed), options.camera.camera) {
  for (const Fault& fault : faults_) Check(fault, sound_.size());
  for (int i = 0; i < sound_.size(); ++i) {
    const bool arrives =
        std::none_of(faults_.begin(), faults_.end(), [i](const Fault& fault) {
          return fault.kind == FaultKind::kThinned && Affects(fault, i) &&
                 (i - fault.first) % kThinning != 0;
        });
    if (arrives) source_.push_back(i);
  }
}

double FaultyDataset::timestamp(int index) const {
  return sound_.timestamp(source_[index]);
}

const SyntheticDataset& FaultyDataset::Source(int source_index) const {
  const bool is_turned = std::any_of(
      faults_.begin(), faults_.end(), [source_index](const Fault& fault) {
        return fault.kind == FaultKind::kTurned && Affects(fault, source_index);
      });
  return is_turned ? turned_ : sound_;
}

Rigid3d FaultyDataset::WorldFromCam(int index) const {
  return Source(source_[index]).WorldFromCam(source_[index]);
}

Frame FaultyDataset::Read(int index) const {
  const int source_index = source_[index];
  Frame frame = Source(source_index).Read(source_index);
  frame.index = index;
  frame.color.release();  // faults are of gray and depth
  for (const Fault& fault : faults_) {
    if (!Affects(fault, source_index)) continue;
    switch (fault.kind) {
      case FaultKind::kBlack:
        frame.gray.setTo(0);
        break;
      case FaultKind::kCovered:
        frame.depth.setTo(0);
        break;
      case FaultKind::kGain:
        frame.gray.convertTo(frame.gray, CV_8U, fault.gain);
        break;
      case FaultKind::kBox:
        DrawBox(source_index, fault.first, &frame);
        break;
      case FaultKind::kTurned:   // handled in Source()
      case FaultKind::kThinned:  // handled in source_
        break;
    }
  }
  return frame;
}

void FaultyDataset::DrawBox(int source_index, int first, Frame* frame) const {
  const double t = (source_index - first) / options_.rate_hz;
  const Rigid3d world_from_box =
      Source(first).WorldFromCam(first) * FirstCamFromBox(t);
  const Rigid3d world_from_cam =
      Source(source_index).WorldFromCam(source_index);
  Rendering box =
      box_renderer_.Render(world_from_box.Inverse() * world_from_cam);

  const double scale = frame->depth_scale;
  const cv::Mat exact = EncodeDepth(box.depth, scale);
  const cv::Mat in_front =
      (exact > 0) & ((frame->depth == 0) | (exact < frame->depth));
  if (options_.noise) {
    const uint64_t key = HashCounter(options_.seed + (kBoxNoise << 32)) +
                         (static_cast<uint64_t>(source_index) << 41);
    AddColorNoise(key, &box.color);
    box.depth = MeasureDepth(box.depth, options_.camera.camera.fx,
                             key + (uint64_t{1} << 40));
  }
  cv::Mat gray;
  cv::cvtColor(box.color, gray, cv::COLOR_BGR2GRAY);
  gray.copyTo(frame->gray, in_front);
  EncodeDepth(box.depth, scale).copyTo(frame->depth, in_front);
}

Trajectory FaultyDataset::ground_truth() const {
  Trajectory trajectory(size());
  for (int i = 0; i < size(); ++i) {
    trajectory[i] = {timestamp(i), WorldFromCam(i)};
  }
  return trajectory;
}

}  // namespace rgbd_pose
