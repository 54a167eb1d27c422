#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "frontend/features/frontend.h"
#include "frontend/features/grid_selection.h"
#include "frontend/features/patch.h"
#include "frontend/frame/image_pyramid.h"
#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// Localisation noise of a corner per image, as in other frontends. Most of it
// is systematic (warp, interpolation, calibration).
constexpr double kPatchSigmaPx = 0.5;

// Residuals of a patch are not white: errors of neighbouring pixels are
// correlated. They move the result this much further than white noise does.
constexpr double kNoiseFactor = 5.0;

// A patch with a lower correlation shows another place. The limit is low, since
// patches with a low correlation already have a large sigma.
constexpr float kMinCorrelation = 0.7F;

// Pyramid of 640 x 480 to 160 x 120.
constexpr int kPatchLevels = 3;

// Patches are rebuilt when their shape has changed by this, which allows an
// error of up to half a pixel at their corners.
constexpr float kWarpStep = 0.125F;

// A surface that has grown or shrunk by more than this factor (in area), or
// that is seen from behind, no longer looks like its patch.
constexpr float kMaxScale = 4.0F;

// The patches of a feature, one per level, as warped by a motion.
struct PatchStack {
  Eigen::Matrix2f ref_from_patch = Eigen::Matrix2f::Zero();  // none yet
  std::array<Patch, kPatchLevels> levels;
};

// The patches of a set of features, as they are needed.
class PatchCache {
 public:
  // Forgets all patches, but keeps their memory.
  void Reset(size_t num_features) {
    patches_.resize(num_features);
    for (PatchStack& patch : patches_) patch.ref_from_patch.setZero();
  }

  // Returns the patches of a feature for a warp close to `ref_from_patch`. They
  // depend on these arguments only, not on earlier calls.
  const PatchStack& Patches(const std::vector<cv::Mat>& pyramid,
                            const cv::Point2f& point, size_t feature,
                            const Eigen::Matrix2f& ref_from_patch) {
    const Eigen::Matrix2f rounded =
        (ref_from_patch / kWarpStep).array().round() * kWarpStep;
    PatchStack& patch = patches_[feature];
    if (patch.ref_from_patch == rounded) return patch;
    patch.ref_from_patch = rounded;
    for (size_t level = 0; level < pyramid.size(); ++level) {
      MakePatch(pyramid[level],
                {ToLevel(point.x, level), ToLevel(point.y, level)}, rounded,
                &patch.levels[level]);
    }
    return patch;
  }

 private:
  std::vector<PatchStack> patches_;
};

struct PatchFeatures : FeatureSet {
  explicit PatchFeatures(const PreparedFrame& frame)
      : pyramid(frame.Derived<ImagePyramid>().levels) {
    pyramid.resize(std::min<size_t>(pyramid.size(), kPatchLevels));
    pyramid[0] = pyramid[0].clone();
  }

  std::vector<cv::Mat> pyramid;  // shares all but level 0 with the frame
  mutable std::weak_ptr<PatchCache> cache;  // see PatchFrontend::CacheOf
};

// Aligns a patch coarse to fine from a start (px). A level that fails is
// skipped, except for the last.
AlignedPatch FindPatch(const PatchStack& patch, int num_levels,
                       const std::vector<cv::Mat>& pyramid,
                       const Eigen::Vector2d& start) {
  auto u = static_cast<float>(start.x());
  auto v = static_cast<float>(start.y());
  AlignedPatch found;
  for (int level = num_levels - 1; level >= 0; --level) {
    // A coarse level only has to provide the start of the next level.
    const float min_step_px = level > 0 ? 0.08F : 0.02F;
    found = AlignPatch(patch.levels[level], pyramid[level], ToLevel(u, level),
                       ToLevel(v, level), min_step_px);
    if (!found.found) continue;
    u = FromLevel(found.u, level);
    v = FromLevel(found.v, level);
  }
  return found;
}

class PatchFrontend final : public Frontend {
 public:
  using Frontend::Frontend;

  void Prepare(const PreparedFrame& frame) const override {
    frame.Derived<ImagePyramid>();
  }

  std::unique_ptr<FeatureSet> Detect(const PreparedFrame& frame) override {
    auto features = std::make_unique<PatchFeatures>(frame);
    for (const cv::Point2f& corner :
         DetectGridCorners(frame, options_.max_features, options_.depth)) {
      AddFeature(frame, corner, kPatchSigmaPx, features.get());
    }
    return features;
  }

  void Match(const FeatureSet& reference, const PreparedFrame& frame,
             const Rigid3d& cur_from_ref_guess,
             FeatureMatches* matches) override {
    matches->Clear();
    const auto& features = static_cast<const PatchFeatures&>(reference);
    const std::vector<cv::Mat>& pyramid = frame.Derived<ImagePyramid>().levels;
    const int num_levels =
        static_cast<int>(std::min(features.pyramid.size(), pyramid.size()));
    const Camera& camera = options_.camera;
    const FrameTiming timing = frame.Timing();
    PatchCache& cache = CacheOf(features);
    for (size_t i = 0; i < features.points.size(); ++i) {
      const Observation& ref = features.observations[i];
      if (ref.depth == 0.0) continue;  // lost with a better velocity
      const Eigen::Vector3d point = cur_from_ref_guess * PointOf(ref);
      if (!(point.z() >= options_.depth.min_depth)) continue;
      const Eigen::Vector2d start = ImagePoint(camera, timing, point);
      if (!camera.Contains(start)) continue;
      const Eigen::Matrix2f warp = PlaneWarp(camera, ref, cur_from_ref_guess);
      const float scale = warp.determinant();
      if (!(scale > 1.0F / kMaxScale && scale < kMaxScale)) continue;
      const PatchStack& patches = cache.Patches(
          features.pyramid, features.points[i], i, warp.inverse());
      const AlignedPatch found = FindPatch(patches, num_levels, pyramid, start);
      if (!found.found || found.correlation < kMinCorrelation) continue;
      const double sigma_px = std::hypot(
          kPatchSigmaPx, kNoiseFactor * found.residual /
                             std::sqrt(patches.levels[0].min_eigenvalue));
      matches->Add(reference, static_cast<int>(i),
                   ObserveAt(frame, {found.u, found.v}, sigma_px));
    }
  }

 private:
  // Patches take more than a megabyte a keyframe, and memory that is used for
  // the first time is slow. Therefore only the keyframes that were matched last
  // have patches.
  PatchCache& CacheOf(const PatchFeatures& features) {
    constexpr size_t kCaches = 3;
    const auto known =
        std::find(caches_.begin(), caches_.end(), features.cache.lock());
    if (known != caches_.end()) {
      std::rotate(known, known + 1, caches_.end());
      return *caches_.back();
    }
    auto cache = std::make_shared<PatchCache>();
    if (caches_.size() == kCaches) {
      *cache = std::move(*caches_.front());
      caches_.erase(caches_.begin());
    }
    cache->Reset(features.points.size());
    features.cache = cache;
    caches_.push_back(std::move(cache));
    return *caches_.back();
  }

  std::vector<std::shared_ptr<PatchCache>> caches_;  // the last used at the end
};

}  // namespace

std::unique_ptr<Frontend> MakePatchFrontend(const FrontendOptions& options) {
  return std::make_unique<PatchFrontend>(options);
}

}  // namespace rgbd_pose
