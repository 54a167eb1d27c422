// The work of a source on a frame, apart from decoding.

#include <benchmark/benchmark.h>

#include "frontend/frame/depth_registration.h"
#include "frontend/simulation/synthetic_dataset.h"

namespace rgbd_pose {
namespace {

// Registers a depth image of 640 x 480 pixels to a colour camera of the same
// size, 25 mm away; distorted lenses take the same time.
void RegisterDepth(benchmark::State& state) {
  SyntheticOptions options;
  options.frames = 1;
  options.depth_camera =
      DepthCamera{options.camera.camera,
                  Rigid3d(Eigen::Quaterniond::Identity(), {0.025, 0.0, 0.0})};
  options.depth_camera->camera.fx = options.depth_camera->camera.fy = 585.0;
  const Frame frame = SyntheticDataset(options).Read(0);
  const DepthRegistration registration(*options.depth_camera,
                                       options.camera.camera);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        registration.Register(frame.depth, frame.depth_scale));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(RegisterDepth)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rgbd_pose
