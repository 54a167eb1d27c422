#include "frontend/fusion/mesh_fusion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/util/parallel_for.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/fusion/voxel_key.h"

namespace rgbd_pose {
namespace {

constexpr int kBlockSide = TsdfVolume::kSide;

void AverageColor(const cv::Vec3b& bgr, float share, DistanceVoxel* voxel) {
  for (int i = 0; i < 3; ++i) {
    const auto mean = static_cast<float>(voxel->color[i]);
    const float seen =
        DistanceVoxel::kColorSteps * static_cast<float>(bgr[2 - i]);
    voxel->color[i] =
        static_cast<uint16_t>(mean + share * (seen - mean) + 0.5F);
  }
}

}  // namespace

std::string MeshFusionOptions::Check() const {
  if (threads < 1) return "at least one thread is needed";
  const double farthest = std::min(depth.max_depth, max_depth);
  if (!(depth.min_depth > 0.0 && farthest > depth.min_depth &&
        farthest <= 1000.0)) {
    return "depth limits must satisfy 0 < min_depth < max_depth <= 1000 m";
  }
  return FusionOptions::Check();
}

MeshFusion::MeshFusion(const MeshFusionOptions& options)
    : options_(options), undistorter_(options.camera) {
  options_.depth.max_depth =
      std::min(options.depth.max_depth, options.max_depth);
  const auto steps =
      static_cast<int>(options_.depth.max_depth * kDepthStepsPerMetre) + 2;
  for (int i = 0; i < steps; ++i) {
    const double sigma =
        options.depth.noise.sigma((i + 0.5) / kDepthStepsPerMetre);
    uses_.push_back({static_cast<float>(options.kTruncation *
                                        std::max(options.voxel_size, sigma)),
                     static_cast<float>(1.0 / (sigma * sigma))});
  }
}

void MeshFusion::Add(const Frame& frame, const Rigid3d& world_from_cam) {
  if (frame.depth_scale != depth_scale_) {
    depth_scale_ = frame.depth_scale;
    max_steps_.assign(Frame::kNoDepth + 1, -1);
    for (int raw = 1; raw < Frame::kNoDepth; ++raw) {
      const double z = raw / depth_scale_;
      const DepthLookupOptions& depth = options_.depth;
      if (z < depth.min_depth || z > depth.max_depth) continue;
      max_steps_[raw] = static_cast<int>(
          std::lround(MaxSurfaceStep(z, depth.noise) * depth_scale_));
    }
  }
  KeepSurfacePixels(frame);
  const Rigid3d cam_from_world = world_from_cam.Inverse();
  std::vector<std::pair<uint64_t, TsdfVolume::Block*>> blocks;
  for (const auto& [key, is_far] : FindBlocks(world_from_cam)) {
    if (is_far && volume_.Find(key) < 0) continue;
    blocks.emplace_back(key, volume_.FindOrInsert(key));
  }
  ParallelFor(static_cast<int>(blocks.size()), options_.threads, [&](int i) {
    AddToBlock(blocks[i].first, cam_from_world, blocks[i].second);
  });
}

// Leaves out what all measurements together do not determine to a voxel.
TriangleMesh MeshFusion::Mesh() const {
  const double sigma = options_.voxel_size;
  return SurfaceMesh(volume_, options_.voxel_size,
                     static_cast<float>(1.0 / (sigma * sigma)));
}

void MeshFusion::KeepSurfacePixels(const Frame& frame) {
  const Frame ideal = undistorter_.Undistort(frame);
  const auto metres_per_unit = static_cast<float>(1.0 / depth_scale_);
  color_ = ideal.color;
  depth_.create(ideal.depth.size(), CV_32FC1);
  depth_.setTo(0.0F);
  for (int y = 1; y < depth_.rows - 1; ++y) {
    const uint16_t* raw = ideal.depth.ptr<uint16_t>(y);
    float* kept = depth_.ptr<float>(y);
    for (int x = 1; x < depth_.cols - 1; ++x) {
      const int max_step = max_steps_[raw[x]];
      if (max_step >= 0 && IsOnSurface(ideal.depth, x, y, max_step)) {
        kept[x] = static_cast<float>(raw[x]) * metres_per_unit;
      }
    }
  }
}

// All blocks that rays pass within the truncation distance of their end points.
// The gaps between rays are smaller than blocks. Only blocks within a few
// voxels of an end point need creating: larger noise spreads the end points.
std::vector<MeshFusion::SeenBlock> MeshFusion::FindBlocks(
    const Rigid3d& world_from_cam) const {
  const Camera& camera = undistorter_.camera();
  // At most half a block between rays at the largest depth.
  const int stride = static_cast<int>(std::clamp(
      kBlockSide * options_.voxel_size * std::min(camera.fx, camera.fy) /
          (2.0 * options_.depth.max_depth),
      1.0, 4.0));  // px
  const auto blocks_per_metre =
      static_cast<float>(1.0 / (kBlockSide * options_.voxel_size));
  const float step = 0.5F / blocks_per_metre;
  const Eigen::Matrix3f R =
      world_from_cam.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = world_from_cam.translation.cast<float>();
  const float near = std::max(
      step, static_cast<float>(options_.kTruncation * options_.voxel_size));
  std::vector<SeenBlock> seen;
  std::vector<SeenBlock> last;  // of the previous ray, by step
  for (int y = 0; y < depth_.rows; y += stride) {
    last.clear();
    for (int x = 0; x < depth_.cols; x += stride) {
      const float end = depth_.at<float>(y, x);
      if (end == 0.0F) continue;
      const float reach = UseOf(end).truncation;
      const Eigen::Vector3f ray = R * camera.Ray(x, y).cast<float>();
      const int steps = static_cast<int>(std::ceil(2.0F * reach / step));
      last.resize(std::max<size_t>(last.size(), steps + 1),
                  SeenBlock(~uint64_t{0}, true));
      for (int i = 0; i <= steps; ++i) {
        const float from_end =
            reach *
            (2.0F * static_cast<float>(i) / static_cast<float>(steps) - 1.0F);
        const float z = end + from_end;
        const Eigen::Vector3f at = (z * ray + t) * blocks_per_metre;
        if (!(at.cwiseAbs().maxCoeff() < kVoxelKeyRange - 1)) continue;
        const Eigen::Vector3i cell(cvFloor(at.x()), cvFloor(at.y()),
                                   cvFloor(at.z()));
        const SeenBlock block(VoxelKey(cell), std::abs(from_end) > near);
        if (block == last[i]) continue;
        last[i] = block;
        seen.push_back(block);
      }
    }
  }
  // Among blocks of the same key a near one comes first.
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end(),
                         [](const SeenBlock& a, const SeenBlock& b) {
                           return a.first == b.first;
                         }),
             seen.end());
  return seen;
}

// Projects each grid point of the block into the depth image.
void MeshFusion::AddToBlock(uint64_t key, const Rigid3d& cam_from_world,
                            TsdfVolume::Block* block) const {
  const Camera& camera = undistorter_.camera();
  const auto fx = static_cast<float>(camera.fx);
  const auto fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx + 0.5);
  const auto cy = static_cast<float>(camera.cy + 0.5);
  const auto width = static_cast<float>(depth_.cols);
  const auto height = static_cast<float>(depth_.rows);
  const Eigen::Matrix3d R = cam_from_world.rotation.toRotationMatrix();
  const Eigen::Matrix3f steps = (R * options_.voxel_size).cast<float>();
  const Eigen::Vector3d first =
      kBlockSide * options_.voxel_size * VoxelOfKey(key).cast<double>();
  const Eigen::Vector3f origin = (cam_from_world * first).cast<float>();
  DistanceVoxel* voxel = block->data();
  for (int i = 0; i < kBlockSide; ++i) {
    for (int j = 0; j < kBlockSide; ++j, voxel += kBlockSide) {
      const Eigen::Vector3f start = origin +
                                    static_cast<float>(i) * steps.col(0) +
                                    static_cast<float>(j) * steps.col(1);
      // This is a separate loop, so that the compiler can vectorise it.
      std::array<float, kBlockSide> us, vs, zs;
      for (int k = 0; k < kBlockSide; ++k) {
        const auto along = static_cast<float>(k);
        zs[k] = start.z() + along * steps(2, 2);
        const float per_z = 1.0F / zs[k];
        us[k] = fx * (start.x() + along * steps(0, 2)) * per_z + cx;
        vs[k] = fy * (start.y() + along * steps(1, 2)) * per_z + cy;
      }
      for (int k = 0; k < kBlockSide; ++k) {
        if (!(zs[k] > 0.0F && us[k] >= 0.0F && us[k] < width && vs[k] >= 0.0F &&
              vs[k] < height)) {
          continue;
        }
        const int x = static_cast<int>(us[k]), y = static_cast<int>(vs[k]);
        const float end = depth_.ptr<float>(y)[x];
        if (end == 0.0F) continue;
        const DepthUse& use = UseOf(end);
        const float before = end - zs[k];
        if (before < -use.truncation) continue;
        const float sum = voxel[k].weight + use.weight;
        const float share = use.weight / sum;
        voxel[k].distance +=
            share * (std::min(before, use.truncation) - voxel[k].distance);
        voxel[k].weight = sum;
        AverageColor(color_.ptr<cv::Vec3b>(y)[x], share, &voxel[k]);
      }
    }
  }
}

}  // namespace rgbd_pose
