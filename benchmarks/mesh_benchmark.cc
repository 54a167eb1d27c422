// Meshes of simulated scenes with known surfaces: accuracy, completeness, time
// and memory, for the tables of docs/exports.md. One process per table row,
// because memory is the peak of the process.

#include <gflags/gflags.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <opencv2/core.hpp>

#include "apps/shell/program.h"
#include "benchmarks/mesh_makers.h"
#include "core/evaluation/trajectory.h"
#include "core/util/input_error.h"
#include "frontend/fusion/voxel_cloud.h"
#include "frontend/simulation/synthetic_dataset.h"

DEFINE_string(scene, "room", "what to look at");
DEFINE_string(path, "circle", "how to move");
DEFINE_int32(frames, 90, "number of frames");
DEFINE_double(rate, 10.0, "frames a second of the path");
DEFINE_string(by, "rgbd_pose", "whose mesh");
DEFINE_double(voxel, 0.01, "side of a voxel (m)");
DEFINE_double(max_depth, rgbd_pose::MeshFusionOptions().max_depth,
              "depths beyond are left out (m)");
DEFINE_string(poses, "",
              "trajectory (TUM text) of a run on the same sequence, in place "
              "of the true poses, all from the same first one");

namespace rgbd_pose {

std::vector<MeshMakerType> MeshMakerTypes() {
  class Ours final : public MeshMaker {
   public:
    explicit Ours(const MeshFusionOptions& options) : fusion_(options) {}
    void Add(const Frame& frame, const Rigid3d& world_from_cam) override {
      fusion_.Add(frame, world_from_cam);
    }
    TriangleMesh Mesh() override { return fusion_.Mesh(); }

   private:
    MeshFusion fusion_;
  };
  return {
      {"rgbd_pose",
       [](const MeshFusionOptions& options) -> std::unique_ptr<MeshMaker> {
         return std::make_unique<Ours>(options);
       }},
#ifdef RGBD_POSE_HAS_OPEN3D
      {"open3d", MakeOpen3dMesh},
#endif
  };
}

namespace {

double CpuSeconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * now.tv_nsec;
}

double PeakMb() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024.0;
}

double DistanceToFace(const SceneFace& face, const Eigen::Vector3d& point) {
  const Eigen::Vector3d from = point - face.origin;
  const double u = from.dot(face.u_axis), v = from.dot(face.v_axis);
  return (from - std::clamp(u, 0.0, face.width) * face.u_axis -
          std::clamp(v, 0.0, face.height) * face.v_axis)
      .norm();
}

double DistanceToScene(const Scene& scene, const Eigen::Vector3d& point) {
  double nearest = 1e9;
  for (const SceneFace& face : scene.faces) {
    nearest = std::min(nearest, DistanceToFace(face, point));
  }
  return nearest;
}

// Errors of the centres of all triangles, weighted by area.
void PrintErrors(const TriangleMesh& mesh, const Scene& scene) {
  std::vector<std::pair<double, double>> errors;  // with the area
  double area = 0.0, sum = 0.0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].position.cast<double>();
    const Eigen::Vector3d b = mesh.vertices[t[1]].position.cast<double>();
    const Eigen::Vector3d c = mesh.vertices[t[2]].position.cast<double>();
    const double size = 0.5 * (b - a).cross(c - a).norm();
    const double error = DistanceToScene(scene, (a + b + c) / 3.0);
    errors.emplace_back(error, size);
    area += size;
    sum += size * error;
  }
  std::sort(errors.begin(), errors.end());
  double seen = 0.0, median = 0.0, p95 = 0.0;
  for (const auto& [error, size] : errors) {
    if (seen < 0.5 * area) median = error;
    if (seen < 0.95 * area) p95 = error;
    seen += size;
  }
  std::printf(
      "mesh %.1f m2, %zu triangles; to surface mean %.2f median %.2f "
      "p95 %.2f mm\n",
      area, mesh.triangles.size(), 1e3 * sum / area, 1e3 * median, 1e3 * p95);
}

// Prints how many of the true points, at which a frame has depth up to the
// limit, have a vertex of the mesh nearby.
void PrintCompleteness(const TriangleMesh& mesh, SyntheticOptions options) {
  options.noise = false;
  const SyntheticDataset exact(options);
  options.noise = true;
  const SyntheticDataset noisy(options);
  static constexpr float kNear = 0.02F;
  std::vector<std::vector<Eigen::Vector3f>> cells(1 << 20);
  const auto slot = [](const Eigen::Vector3i& cell) {
    return static_cast<uint32_t>(cell[0] * 73856093 ^ cell[1] * 19349663 ^
                                 cell[2] * 83492791) &
           ((1 << 20) - 1);
  };
  const auto cell_of = [](const Eigen::Vector3f& p) {
    return Eigen::Vector3i((p / kNear).array().floor().cast<int>());
  };
  for (const ColoredPoint& vertex : mesh.vertices) {
    cells[slot(cell_of(vertex.position))].push_back(vertex.position);
  }
  VoxelCloud truth(0.02F);
  const Camera& camera = options.camera.camera;
  for (int i = 0; i < exact.size(); i += 3) {
    const Frame frame = exact.Read(i);
    const Frame measured = noisy.Read(i);
    for (int y = 0; y < frame.depth.rows; y += 4) {
      for (int x = 0; x < frame.depth.cols; x += 4) {
        const double z = frame.DepthAt(x, y);
        if (z == 0.0 || z > FLAGS_max_depth || measured.DepthAt(x, y) == 0.0) {
          continue;
        }
        ColoredPoint point;
        point.position =
            (exact.WorldFromCam(i) * camera.Unproject({x, y}, z)).cast<float>();
        truth.Add(point);
      }
    }
  }
  size_t close[2] = {0, 0};
  for (const ColoredPoint& point : truth.Points()) {
    float nearest = 1e9F;
    const Eigen::Vector3i cell = cell_of(point.position);
    for (int n = 0; n < 27; ++n) {
      const Eigen::Vector3i other =
          cell + Eigen::Vector3i(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
      for (const Eigen::Vector3f& p : cells[slot(other)]) {
        nearest = std::min(nearest, (p - point.position).norm());
      }
    }
    close[0] += nearest < 0.01F;
    close[1] += nearest < 0.02F;
  }
  std::printf("complete within 1 cm %.1f %%, 2 cm %.1f %% (%d points)\n",
              100.0 * close[0] / truth.size(), 100.0 * close[1] / truth.size(),
              truth.size());
}

std::vector<Rigid3d> Poses(const SyntheticDataset& dataset) {
  std::vector<Rigid3d> poses;
  for (int i = 0; i < dataset.size(); ++i) {
    poses.push_back(dataset.WorldFromCam(i));
  }
  if (FLAGS_poses.empty()) return poses;
  const Trajectory estimate = ReadTrajectory(FLAGS_poses);
  if (static_cast<int>(estimate.size()) != dataset.size()) {
    throw InputError(FLAGS_poses + ": has not a pose for every frame");
  }
  const Rigid3d truth_from_estimate =
      poses[0] * estimate[0].world_from_cam.Inverse();
  for (int i = 0; i < dataset.size(); ++i) {
    poses[i] = truth_from_estimate * estimate[i].world_from_cam;
  }
  return poses;
}

int Main() {
  cv::setNumThreads(1);
  SyntheticOptions options;
  options.scene = FLAGS_scene;
  options.path = FLAGS_path;
  options.frames = FLAGS_frames;
  options.rate_hz = FLAGS_rate;
  const SyntheticDataset dataset(options);
  MeshFusionOptions fusion;
  fusion.camera = options.camera.camera;
  fusion.voxel_size = FLAGS_voxel;
  fusion.depth.max_depth = fusion.max_depth = FLAGS_max_depth;
  std::unique_ptr<MeshMaker> maker;
  for (const MeshMakerType& type : MeshMakerTypes()) {
    if (type.name == FLAGS_by) maker = type.make(fusion);
  }
  if (maker == nullptr) throw InputError("--by: unknown " + FLAGS_by);
  const std::vector<Rigid3d> world_from_cam = Poses(dataset);
  double seconds = 0.0;
  std::vector<double> each;
  const double before_mb = PeakMb();
  for (int i = 0; i < dataset.size(); ++i) {
    const Frame frame = dataset.Read(i);
    const double start = CpuSeconds();
    maker->Add(frame, world_from_cam[i]);
    each.push_back(CpuSeconds() - start);
    seconds += each.back();
  }
  const double fused_mb = PeakMb();
  const double start = CpuSeconds();
  const TriangleMesh mesh = maker->Mesh();
  std::sort(each.begin(), each.end());
  std::printf("%s: %.1f frames/s a core (median %.1f), mesh in %.2f s\n",
              FLAGS_by.c_str(), dataset.size() / seconds,
              1.0 / each[each.size() / 2], CpuSeconds() - start);
  std::printf("memory %.0f MB before, %.0f MB after fusing, %.0f MB in all\n",
              before_mb, fused_mb, PeakMb());
  PrintErrors(mesh, MakeScene(FLAGS_scene, options.seed));
  PrintCompleteness(mesh, options);
  return kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  const rgbd_pose::ProgramInfo info = {
      "mesh_benchmark",
      "meshes of simulated scenes",
      "mesh_benchmark --by=rgbd_pose",
      {{"All",
        {"scene", "path", "frames", "rate", "by", "voxel", "max_depth",
         "poses"}}}};
  return rgbd_pose::RunProgram(argc, argv, info, rgbd_pose::Main);
}
