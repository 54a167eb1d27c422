#pragma once

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_hash.h"
#include "frontend/simulation/synthetic_renderer.h"
#include "frontend/simulation/synthetic_scene.h"
#include "frontend/simulation/synthetic_sensor.h"

namespace rgbd_pose {

// A printed box that circles in front of the camera of a simulated sequence.
//
// The box is 0.62 x 0.46 x 0.2 m. In its first frame, its front is 0.8 m ahead
// of the camera: 40 % of a 640 x 480 image. Its centre moves on a circle of 0.1
// m radius at 0.3 m/s, upright to and fixed in the axes of that first pose. It
// hides what is farther away in both images, has the sensor's noise if the
// sequence has noise, and is always sharp.
class CirclingBox {
 public:
  // `first`: the first frame with the box.
  CirclingBox(const SyntheticOptions& options, int first)
      : options_(options),
        first_(first),
        dataset_(options),
        renderer_(MakeBox(options.seed), options.camera.camera) {}

  // Draws the box into gray levels and depth of a frame of the sequence.
  void DrawInto(int index, Frame* frame) const {
    const Rigid3d world_from_box =
        dataset_.WorldFromCam(first_) *
        FirstCamFromBox((index - first_) / options_.rate_hz);
    Rendering box = renderer_.Render(world_from_box.Inverse() *
                                     dataset_.WorldFromCam(index));
    const double scale = frame->depth_scale;
    const cv::Mat exact = EncodeDepth(box.depth, scale);
    const cv::Mat in_front =
        (exact > 0) & ((frame->depth == 0) | (exact < frame->depth));
    if (options_.noise) {
      constexpr uint64_t kBoxNoise = 0x626f78;  // seed that separates its noise
      const uint64_t key = HashCounter(options_.seed + (kBoxNoise << 32)) +
                           (static_cast<uint64_t>(index) << 41);
      AddColorNoise(key, &box.color);
      box.depth = MeasureDepth(box.depth, options_.camera.camera.fx,
                               key + (uint64_t{1} << 40));
    }
    cv::Mat gray;
    cv::cvtColor(box.color, gray, cv::COLOR_BGR2GRAY);
    gray.copyTo(frame->gray, in_front);
    EncodeDepth(box.depth, scale).copyTo(frame->depth, in_front);
  }

 private:
  static constexpr double kDepth = 0.20;  // m

  // In axes of its own: x along its width, z up, from its centre.
  static Scene MakeBox(uint32_t seed) {
    Material print;
    print.color = {0.45f, 0.55f, 0.62f};
    print.tile = {0.09f, 0.07f};
    print.tile_contrast = 0.2f;
    print.tile_tint = 0.15f;
    print.glyph = 0.008f;
    print.glyph_density = 0.4f;
    Scene scene = {{}, {0.3, -1.5, 1.0}, seed};
    AddBox({{0.0, 0.0, -0.23}, {0.62, kDepth, 0.46}, 0.0}, false,
           {print, print, print, print, print, print}, &scene);
    return scene;
  }

  // The box `t` seconds after it appears, in axes of the camera at that frame.
  static Rigid3d FirstCamFromBox(double t) {
    constexpr double kFront = 0.8, kRadius = 0.1;  // m
    constexpr double kSpeed = 0.3;                 // m/s
    const double angle = kSpeed / kRadius * t;
    Eigen::Matrix3d upright;  // right, forward, up to right, down, forward
    upright << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    return Rigid3d(Eigen::Quaterniond(upright),
                   {kRadius * std::cos(angle), kRadius * std::sin(angle),
                    kFront + kDepth / 2.0});
  }

  SyntheticOptions options_;
  int first_;
  SyntheticDataset dataset_;
  Renderer renderer_;
};

}  // namespace rgbd_pose
