#include "frontend/synthetic_dataset.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/input_error.h"
#include "frontend/synthetic_hash.h"
#include "frontend/synthetic_sensor.h"

namespace rgbd_pose {
namespace {

constexpr double kFirstStamp = 1000.0;  // s

const SyntheticOptions& Checked(const SyntheticOptions& options) {
  if (options.frames < 1) {
    throw InputError("a synthetic sequence needs at least 1 frame, not " +
                     std::to_string(options.frames));
  }
  // Time stamps are whole microseconds and must differ.
  if (!(options.rate_hz > 0.0 && options.rate_hz <= 1e5)) {
    throw InputError("the rate of a synthetic sequence must be in 0..1e5 Hz");
  }
  if (!(options.camera.depth_scale > 0.0)) {
    throw InputError("depth_scale of a synthetic sequence must be positive");
  }
  const std::string problem = options.camera.camera.Check();
  if (!problem.empty()) {
    throw InputError("camera of the synthetic sequence: " + problem);
  }
  return options;
}

}  // namespace

SyntheticDataset::SyntheticDataset(const SyntheticOptions& options)
    : options_(Checked(options)),
      path_(FindSyntheticPath(options.path)),
      renderer_(MakeScene(options.scene, options.seed), options.camera.camera) {
}

double SyntheticDataset::timestamp(int index) const {
  return std::round((kFirstStamp + index / options_.rate_hz) * 1e6) / 1e6;
}

Rigid3d SyntheticDataset::WorldFromCam(int index) const {
  return path_(index / options_.rate_hz,
               (options_.frames - 1) / options_.rate_hz);
}

RgbdImages SyntheticDataset::ReadImages(int index) const {
  Rendering rendering = renderer_.Render(WorldFromCam(index));
  if (options_.noise) {
    // One key an image; images take less than 2^40 numbers after theirs.
    const uint64_t sequence = HashCounter(options_.seed);
    const uint64_t frame = static_cast<uint64_t>(index) << 41;
    AddColorNoise(sequence + frame, &rendering.color);
    rendering.depth = MeasureDepth(rendering.depth, options_.camera.camera.fx,
                                   sequence + frame + (uint64_t{1} << 40));
  }
  return {rendering.color,
          EncodeDepth(rendering.depth, options_.camera.depth_scale)};
}

Frame SyntheticDataset::Read(int index) const {
  const RgbdImages images = ReadImages(index);
  Frame frame;
  frame.index = index;
  frame.timestamp = timestamp(index);
  cv::cvtColor(images.color, frame.gray, cv::COLOR_BGR2GRAY);
  frame.depth = images.depth;
  frame.depth_scale = options_.camera.depth_scale;
  return frame;
}

Trajectory SyntheticDataset::ground_truth() const {
  Trajectory trajectory(size());
  for (int i = 0; i < size(); ++i) {
    trajectory[i] = {timestamp(i), WorldFromCam(i)};
  }
  return trajectory;
}

}  // namespace rgbd_pose
