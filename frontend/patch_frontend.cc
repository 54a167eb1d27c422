#include "frontend/patch_frontend.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "frontend/coarse_alignment.h"
#include "frontend/grid_corners.h"
#include "frontend/image_pyramid.h"
#include "frontend/observe.h"
#include "frontend/patch.h"
#include "frontend/patch_alignment.h"
#include "frontend/plane_warp.h"

namespace rgbd_pose {
namespace {

double Env(const char* n, double d) {
  const char* s = std::getenv(n);
  return s ? atof(s) : d;
}
const int kStart = Env("T_START", 2);
const float kMinCorr = Env("T_CORR", 0.8);
const double kFloor = Env("T_FLOOR", 0.5);
const double kSigK = Env("T_SIGK", 0);
const float kQ = Env("T_Q", 16);
const bool kCoarse = Env("T_COARSE", 1);
const float kShift2 = Env("T_SHIFT2", 3);
const float kShift1 = Env("T_SHIFT1", 2);
const float kShift0 = Env("T_SHIFT0", 2);
const float kEps0 = Env("T_EPS", 0.02);
const int kL0 = Env("T_L0", 8);

constexpr int kLevels = 6;

// A reference patch at its levels, as a motion makes it look.
struct PatchStack {
  Eigen::Matrix2f ref_from_patch = Eigen::Matrix2f::Zero();
  Patch<8> level2, level1, level08;
  Patch<16> level0;
};

struct PatchFeatures : FeatureSet {
  PatchFeatures(const Frame& frame, const Camera& camera) {
    if (frame.pyramid.empty()) {
      BuildImagePyramid(frame.gray, kLevels, &pyramid);
    } else {
      pyramid = frame.pyramid;
    }
    coarse = std::make_unique<CoarseReference>(frame, pyramid, camera);
  }
  std::vector<cv::Mat> pyramid;
  std::unique_ptr<CoarseReference> coarse;
  std::vector<cv::Point2f> corners;
  mutable std::vector<PatchStack> patches;
};

}  // namespace

PatchFrontend::PatchFrontend(const FrontendOptions& options)
    : options_(options),
      depth_options_{options.depth_noise, options.min_depth,
                     options.max_depth} {}

void PatchFrontend::Prepare(Frame* frame) const {
  BuildImagePyramid(frame->gray, kLevels, &frame->pyramid);
}

const std::vector<cv::Mat>& PatchFrontend::PyramidOf(const Frame& frame) {
  if (!frame.pyramid.empty()) return frame.pyramid;
  BuildImagePyramid(frame.gray, kLevels, &pyramid_);
  return pyramid_;
}

std::unique_ptr<FeatureSet> PatchFrontend::Detect(const Frame& frame) {
  auto features = std::make_unique<PatchFeatures>(frame, options_.camera);
  features->corners = DetectGridCorners(
      frame.gray, options_.max_features, [&](const cv::Point2f& pixel) {
        return LookUpDepth(frame, pixel.x, pixel.y, depth_options_).depth > 0.0;
      });
  for (const cv::Point2f& corner : features->corners) {
    features->observations.push_back(Observe(
        frame, options_.camera, corner.x, corner.y, 0.5, depth_options_));
  }
  features->patches.resize(features->corners.size());
  return features;
}

int g_stat[8];
struct Dump { ~Dump() { if (getenv("T_STAT")) fprintf(stderr, "features %d behind %d, l2 miss %d, l1 miss %d, l0 miss %d, corr %d, remade %d\n", g_stat[0], g_stat[1], g_stat[2], g_stat[3], g_stat[4], g_stat[5], g_stat[6]); } } g_dump;

void PatchFrontend::Match(const FeatureSet& reference, const Frame& frame,
                          const Rigid3d& cur_from_ref_guess,
                          FeatureMatches* matches) {
  matches->Clear();
  const auto& features = static_cast<const PatchFeatures&>(reference);
  if (features.corners.empty()) return;
  const std::vector<cv::Mat>& pyramid = PyramidOf(frame);
  const Rigid3d cur_from_ref =
      kCoarse ? features.coarse->Align(pyramid, cur_from_ref_guess)
              : cur_from_ref_guess;
  for (size_t i = 0; i < features.corners.size(); ++i) {
    const Observation& ref = features.observations[i];
    const Eigen::Vector3d point = cur_from_ref * matches->matches.Point(ref);
    ++g_stat[0];
    if (point.z() < options_.min_depth) continue;
    const Eigen::Vector2f pixel = options_.camera.Project(point).cast<float>();
    if (!options_.camera.Contains(pixel.cast<double>())) { ++g_stat[1]; continue; }
    const Eigen::Matrix2f warp =
        PlaneWarp(options_.camera, ref, cur_from_ref).inverse();
    const Eigen::Matrix2f rounded =
        (warp * kQ).array().round().matrix() / kQ;
    PatchStack& patch = features.patches[i];
    if (patch.ref_from_patch != rounded) {
      ++g_stat[6];
      patch.ref_from_patch = rounded;
      const cv::Point2f c = features.corners[i];
      MakePatch(features.pyramid[2], {ToLevel(c.x, 2), ToLevel(c.y, 2)},
                rounded, &patch.level2);
      MakePatch(features.pyramid[1], {ToLevel(c.x, 1), ToLevel(c.y, 1)},
                rounded, &patch.level1);
      if (kL0 == 16)
      MakePatch(features.pyramid[0], {c.x, c.y}, rounded, &patch.level0);
      else
      MakePatch(features.pyramid[0], {c.x, c.y}, rounded, &patch.level08);
    }
    float u = pixel.x(), v = pixel.y();
    AlignedPatch at;
    if (kStart >= 2) {
      at = AlignPatch(patch.level2, pyramid[2], ToLevel(u, 2), ToLevel(v, 2),
                      {8, 0.1F, kShift2});
      if (at.found) {
        u = FromLevel(at.u, 2);
        v = FromLevel(at.v, 2);
      } else ++g_stat[2];
    }
    if (kStart >= 1) {
      at = AlignPatch(patch.level1, pyramid[1], ToLevel(u, 1), ToLevel(v, 1),
                      {8, 0.05F, kShift1});
      if (at.found) {
        u = FromLevel(at.u, 1);
        v = FromLevel(at.v, 1);
      } else ++g_stat[3];
    }
    at = kL0 == 16 ? AlignPatch(patch.level0, pyramid[0], u, v, {8, kEps0, kShift0}) :
       AlignPatch(patch.level08, pyramid[0], u, v, {8, kEps0, kShift0});
    if (!at.found) { ++g_stat[4]; continue;}
    if (at.correlation < kMinCorr) { ++g_stat[5]; continue;}
    const double noise = kSigK * at.residual / std::sqrt(kL0 == 16 ? patch.level0.min_eigenvalue : patch.level08.min_eigenvalue);
    matches->Add(reference, static_cast<int>(i),
                 Observe(frame, options_.camera, at.u, at.v, std::hypot(kFloor, noise),
                         depth_options_));
  }
}

}  // namespace rgbd_pose
