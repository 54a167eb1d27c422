#include "frontend/mesh/mesh_fusion.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "frontend/image/surface_pixel.h"
#include "frontend/image/undistorter.h"

namespace rgbd_pose {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::Vec3SGrid;

constexpr double kMinVoxelSize = 0.001;  // m
constexpr double kMaxVoxelSize = 1.0;    // m

constexpr int kSide = FloatGrid::TreeType::LeafNodeType::DIM;  // of a block
constexpr int kLog2Side = FloatGrid::TreeType::LeafNodeType::LOG2DIM;

// What is done with a depth, by steps of depth so small that the table stays
// near the processor.
struct DepthValue {
  float truncation = 0.0F;  // m
  float weight = 0.0F;      // 1 / m^2; 0: too near or too far
};
constexpr double kStepsPerMetre = 512.0;

// Blocks as numbers that can be sorted: 21 bits an axis.
constexpr int kBits = 21;
constexpr int kHalfRange = 1 << (kBits - 1);

uint64_t KeyOf(const Coord& block) {
  uint64_t key = 0;
  for (int i = 0; i < 3; ++i) {
    key = key << kBits | static_cast<uint32_t>(block[i] + kHalfRange);
  }
  return key;
}

Coord BlockOf(uint64_t key) {
  constexpr uint64_t kMask = (uint64_t{1} << kBits) - 1;
  Coord block;
  for (int i = 2; i >= 0; --i, key >>= kBits) {
    block[i] = static_cast<int>(key & kMask) - kHalfRange;
  }
  return block;
}

// As openvdb makes grids of files: to have the compiler make them here takes it
// half a minute.
template <typename Grid>
typename Grid::Ptr MakeGrid(const char* type) {
  openvdb::initialize();
  return openvdb::gridPtrCast<Grid>(openvdb::GridBase::createGrid(type));
}

Eigen::Vector3f ToEigen(const openvdb::Vec3s& v) { return {v[0], v[1], v[2]}; }

}  // namespace

std::string MeshFusionOptions::Check() const {
  if (!(voxel_size >= kMinVoxelSize && voxel_size <= kMaxVoxelSize)) {
    return "the voxel size must be 0.001 to 1 m";
  }
  if (!(truncation_voxels >= 1.0) || !(truncation_sigmas >= 0.0)) {
    return "the truncation must be at least one voxel";
  }
  if (!(max_sigma >= 0.0)) return "max_sigma must not be negative";
  if (depth.noise == nullptr) return "a depth noise model is needed";
  if (!(depth.min_depth > 0.0) || !(depth.max_depth > depth.min_depth)) {
    return "depth limits must satisfy 0 < min_depth < max_depth";
  }
  return camera.Check();
}

struct MeshFusion::Volume {
  explicit Volume(const MeshFusionOptions& options);

  void SetDepthScale(double depth_scale);
  const DepthValue& ValueOf(float depth) const;
  void KeepSurfacePixels(const Frame& frame);
  std::vector<uint64_t> FindBlocks(const Rigid3d& world_from_cam) const;
  void AddToBlock(const Coord& block, const Rigid3d& cam_from_world);
  bool IsKnown(const Coord& voxel, float min_weight,
               const FloatGrid::ConstAccessor& weight) const;
  ColoredPoint Vertex(const openvdb::Vec3s& position,
                      const FloatGrid::ConstAccessor& weights,
                      const Vec3SGrid::ConstAccessor& colors) const;

  MeshFusionOptions options;
  Undistorter undistorter;
  double depth_scale = 0.0;
  std::vector<DepthValue> values;  // by steps of depth
  std::vector<int> max_steps;      // to neighbours, by raw depth; -1: no depth
  cv::Mat depth;  // of the frame at hand: CV_32FC1, m, 0 off surfaces
  cv::Mat color;
  size_t num_blocks = 0;

  // At the corners of voxels: distance to the surface (m; > 0 before it),
  // weight, colour.
  FloatGrid::Ptr distances = MakeGrid<FloatGrid>("Tree_float_5_4_3");
  FloatGrid::Ptr weights = MakeGrid<FloatGrid>("Tree_float_5_4_3");
  Vec3SGrid::Ptr colors = MakeGrid<Vec3SGrid>("Tree_vec3s_5_4_3");
  FloatGrid::Accessor distance_at = distances->getAccessor();
  FloatGrid::Accessor weight_at = weights->getAccessor();
  Vec3SGrid::Accessor color_at = colors->getAccessor();
};

MeshFusion::Volume::Volume(const MeshFusionOptions& options)
    : options(options), undistorter(options.camera) {
  const auto steps =
      static_cast<int>(options.depth.max_depth * kStepsPerMetre) + 2;
  for (int i = 0; i < steps; ++i) {
    const double sigma = options.depth.noise->sigma((i + 0.5) / kStepsPerMetre);
    values.push_back({static_cast<float>(std::max(
                          options.truncation_voxels * options.voxel_size,
                          options.truncation_sigmas * sigma)),
                      static_cast<float>(1.0 / (sigma * sigma))});
  }
  distances->setTransform(
      openvdb::math::Transform::createLinearTransform(options.voxel_size));
}

void MeshFusion::Volume::SetDepthScale(double scale) {
  if (scale == depth_scale) return;
  depth_scale = scale;
  max_steps.assign(Frame::kNoDepth + 1, -1);
  for (int raw = 1; raw < Frame::kNoDepth; ++raw) {
    const double z = raw / scale;
    if (z < options.depth.min_depth || z > options.depth.max_depth) continue;
    max_steps[raw] = static_cast<int>(
        std::lround(MaxSurfaceStep(z, *options.depth.noise) * scale));
  }
}

const DepthValue& MeshFusion::Volume::ValueOf(float depth) const {
  return values[static_cast<size_t>(depth *
                                    static_cast<float>(kStepsPerMetre))];
}

void MeshFusion::Volume::KeepSurfacePixels(const Frame& frame) {
  const Frame ideal = undistorter.Undistort(frame);
  const auto metres_per_unit = static_cast<float>(1.0 / depth_scale);
  color = ideal.color;
  depth.create(ideal.depth.size(), CV_32FC1);
  depth.setTo(0.0F);
  for (int y = 1; y < depth.rows - 1; ++y) {
    const uint16_t* raw = ideal.depth.ptr<uint16_t>(y);
    float* kept = depth.ptr<float>(y);
    for (int x = 1; x < depth.cols - 1; ++x) {
      const int max_step = max_steps[raw[x]];
      if (max_step >= 0 && IsOnSurface(ideal.depth, x, y, max_step)) {
        kept[x] = static_cast<float>(raw[x]) * metres_per_unit;
      }
    }
  }
}

// All that rays pass within the truncation of where they end. Blocks are much
// larger than what is between neighbouring rays.
std::vector<uint64_t> MeshFusion::Volume::FindBlocks(
    const Rigid3d& world_from_cam) const {
  constexpr int kStride = 4;  // px
  const Camera& camera = undistorter.camera();
  const auto blocks_per_metre =
      static_cast<float>(1.0 / (kSide * options.voxel_size));
  const float step = 0.5F / blocks_per_metre;
  const Eigen::Matrix3f R =
      world_from_cam.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f t = world_from_cam.translation.cast<float>();
  std::vector<uint64_t> keys;
  std::vector<uint64_t> last;  // of the ray before, step by step
  for (int y = 0; y < depth.rows; y += kStride) {
    last.clear();
    for (int x = 0; x < depth.cols; x += kStride) {
      const float end = depth.at<float>(y, x);
      if (end == 0.0F) continue;
      const DepthValue& value = ValueOf(end);
      const Eigen::Vector3f ray = R * camera.Ray(x, y).cast<float>();
      const int steps =
          static_cast<int>(std::ceil(2.0F * value.truncation / step));
      last.resize(std::max<size_t>(last.size(), steps + 1), ~uint64_t{0});
      for (int i = 0; i <= steps; ++i) {
        const float z =
            end + value.truncation * (2.0F * static_cast<float>(i) /
                                          static_cast<float>(steps) -
                                      1.0F);
        const Eigen::Vector3f at = (z * ray + t) * blocks_per_metre;
        if (!(at.cwiseAbs().maxCoeff() < kHalfRange)) continue;
        const uint64_t key = KeyOf(Coord(static_cast<int>(std::floor(at.x())),
                                         static_cast<int>(std::floor(at.y())),
                                         static_cast<int>(std::floor(at.z()))));
        if (key == last[i]) continue;
        last[i] = key;
        keys.push_back(key);
      }
    }
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

void MeshFusion::Volume::AddToBlock(const Coord& block,
                                    const Rigid3d& cam_from_world) {
  const Coord first(block[0] * kSide, block[1] * kSide, block[2] * kSide);
  auto* distance_leaf = distance_at.probeLeaf(first);
  if (distance_leaf == nullptr) {
    distance_leaf = distance_at.touchLeaf(first);
    distance_leaf->setValuesOn();
    ++num_blocks;
  }
  float* distance = distance_leaf->buffer().data();
  float* weight = weight_at.touchLeaf(first)->buffer().data();
  openvdb::Vec3s* mean = color_at.touchLeaf(first)->buffer().data();

  const Camera& camera = undistorter.camera();
  const auto fx = static_cast<float>(camera.fx);
  const auto fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx + 0.5);
  const auto cy = static_cast<float>(camera.cy + 0.5);
  const auto width = static_cast<float>(depth.cols);
  const auto height = static_cast<float>(depth.rows);
  const Eigen::Matrix3d R = cam_from_world.rotation.toRotationMatrix();
  const Eigen::Matrix3f steps = (R * options.voxel_size).cast<float>();
  const Eigen::Vector3f origin =
      (cam_from_world *
       (options.voxel_size * Eigen::Vector3d(first[0], first[1], first[2])))
          .cast<float>();
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const Eigen::Vector3f start = origin +
                                    static_cast<float>(i) * steps.col(0) +
                                    static_cast<float>(j) * steps.col(1);
      // Apart from what follows, for the sake of vectors.
      std::array<float, kSide> us, vs, zs;
      for (int k = 0; k < kSide; ++k) {
        zs[k] = start.z() + static_cast<float>(k) * steps(2, 2);
        const float per_z = 1.0F / zs[k];
        us[k] =
            fx * (start.x() + static_cast<float>(k) * steps(0, 2)) * per_z + cx;
        vs[k] =
            fy * (start.y() + static_cast<float>(k) * steps(1, 2)) * per_z + cy;
      }
      for (int k = 0; k < kSide; ++k) {
        const float u = us[k], v = vs[k], z = zs[k];
        if (!(z > 0.0F && u >= 0.0F && u < width && v >= 0.0F && v < height)) {
          continue;
        }
        const int x = static_cast<int>(u), y = static_cast<int>(v);
        const float end = depth.ptr<float>(y)[x];
        if (end == 0.0F) continue;
        const DepthValue& value = ValueOf(end);
        const float before = end - z;
        if (before < -value.truncation) continue;
        const int at = i << 2 * kLog2Side | j << kLog2Side | k;
        const float sum = weight[at] + value.weight;
        const float share = value.weight / sum;
        distance[at] +=
            share * (std::min(before, value.truncation) - distance[at]);
        weight[at] = sum;
        const cv::Vec3b& bgr = color.ptr<cv::Vec3b>(y)[x];
        for (int c = 0; c < 3; ++c) {
          mean[at][c] += share * (static_cast<float>(bgr[2 - c]) - mean[at][c]);
        }
      }
    }
  }
}

// Whether all corners of a voxel are known well enough.
bool MeshFusion::Volume::IsKnown(const Coord& voxel, float min_weight,
                                 const FloatGrid::ConstAccessor& weight) const {
  for (int corner = 0; corner < 8; ++corner) {
    if (weight.getValue(voxel.offsetBy(corner >> 2, corner >> 1 & 1,
                                       corner & 1)) < min_weight) {
      return false;
    }
  }
  return true;
}

// Its colour is that of the corners around it, by weight and nearness.
ColoredPoint MeshFusion::Volume::Vertex(
    const openvdb::Vec3s& position, const FloatGrid::ConstAccessor& weights,
    const Vec3SGrid::ConstAccessor& colors) const {
  const openvdb::Vec3d at = distances->worldToIndex(position);
  const Coord first = Coord::floor(at);
  openvdb::Vec3d sum(0.0);
  double total = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Coord c = first.offsetBy(corner >> 2, corner >> 1 & 1, corner & 1);
    double share = weights.getValue(c);
    for (int i = 0; i < 3; ++i) share *= 1.0 - std::abs(at[i] - c[i]);
    sum += share * openvdb::Vec3d(colors.getValue(c));
    total += share;
  }
  const openvdb::Vec3d mean = sum / std::max(total, 1e-12);
  ColoredPoint point;
  point.position = ToEigen(position);
  point.red = static_cast<uint8_t>(std::lround(mean[0]));
  point.green = static_cast<uint8_t>(std::lround(mean[1]));
  point.blue = static_cast<uint8_t>(std::lround(mean[2]));
  return point;
}

MeshFusion::MeshFusion(const MeshFusionOptions& options)
    : volume_(std::make_unique<Volume>(options)) {}

MeshFusion::~MeshFusion() = default;

void MeshFusion::Add(const Frame& frame, const Rigid3d& world_from_cam) {
  volume_->SetDepthScale(frame.depth_scale);
  volume_->KeepSurfacePixels(frame);
  const Rigid3d cam_from_world = world_from_cam.Inverse();
  for (const uint64_t key : volume_->FindBlocks(world_from_cam)) {
    volume_->AddToBlock(BlockOf(key), cam_from_world);
  }
}

TriangleMesh MeshFusion::Mesh() const {
  const double sigma = volume_->options.max_sigma > 0.0
                           ? volume_->options.max_sigma
                           : volume_->options.voxel_size;
  const auto min_weight = static_cast<float>(1.0 / (sigma * sigma));
  // A point for each voxel that the surface passes, polygons between those of
  // neighbours.
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*volume_->distances, points, quads);

  // Where the surface ends, it also has polygons between what is known of it
  // and what is not.
  TriangleMesh mesh;
  const auto weights = volume_->weights->getConstAccessor();
  const auto colors = volume_->colors->getConstAccessor();
  std::vector<int> vertex_of_point(points.size(), -1);
  for (size_t i = 0; i < points.size(); ++i) {
    const Coord voxel =
        Coord::floor(volume_->distances->worldToIndex(points[i]));
    if (!volume_->IsKnown(voxel, min_weight, weights)) continue;
    vertex_of_point[i] = static_cast<int>(mesh.vertices.size());
    mesh.vertices.push_back(volume_->Vertex(points[i], weights, colors));
  }
  for (const openvdb::Vec4I& quad : quads) {
    std::array<int, 4> corners;
    for (int i = 0; i < 4; ++i) corners[i] = vertex_of_point[quad[i]];
    if (*std::min_element(corners.begin(), corners.end()) < 0) continue;
    const auto at = [&](int i) { return mesh.vertices[corners[i]].position; };
    // Along the shorter diagonal.
    const int from =
        (at(0) - at(2)).squaredNorm() <= (at(1) - at(3)).squaredNorm() ? 0 : 1;
    for (const int to : {from + 1, from + 2}) {
      mesh.triangles.emplace_back(corners[from], corners[to],
                                  corners[(to + 1) % 4]);
    }
  }
  return mesh;
}

size_t MeshFusion::MemoryBytes() const {
  return volume_->num_blocks *
         (2 * sizeof(FloatGrid::TreeType::LeafNodeType) +
          sizeof(Vec3SGrid::TreeType::LeafNodeType) +
          kSide * kSide * kSide * (2 * sizeof(float) + sizeof(openvdb::Vec3s)));
}

}  // namespace rgbd_pose
