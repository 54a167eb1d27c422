// Estimates the camera motion of an RGB-D sequence.

#include <gflags/gflags.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "apps/run/run_tracking.h"
#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/quantile.h"
#include "frontend/settings/sequence.h"

DEFINE_bool(validate_only, false,
            "only read every image and print the speed; needs no --output");

namespace rgbd_pose {
namespace {

ProgramInfo Info(RunSettings* settings) {
  return {"rgbd_odometry",
          "estimates the motion of an RGB-D camera along a sequence.",
          "rgbd_odometry rgbd_dataset_freiburg1_xyz --camera=tum_fr1",
          {{"Run", {"report", "validate_only", "finish_on_signal", "threads"}}},
          {SettingTable(&settings->sequence), SettingTable(&settings->odometry),
           SettingTable(&settings->output), SettingTable(&settings->view)},
          {},
          /*has_default_output=*/true};
}

int ValidateOnly(const Sequence& sequence, int threads) {
  FrameSource* const source = sequence.source.get();
  const auto start = std::chrono::steady_clock::now();
  std::vector<double> decode_ms;
  std::vector<std::string> damaged;
  {
    ProgressBar bar("reading", static_cast<int>(source->timestamps().size()));
    FrameStream stream(source, nullptr, threads, sequence.inputs.max_damaged);
    while (const auto next = stream.Next()) {
      decode_ms.push_back(next->decode_ms);
      bar.Update(static_cast<int>(decode_ms.size()));
    }
    if (!stream.stopped().empty()) throw InputError(stream.stopped());
    damaged = stream.damaged();
  }
  Warn(DroppedFrames(*source, damaged));
  const auto frames = static_cast<int>(decode_ms.size());
  std::printf("frames      %d, %s\n", frames,
              damaged.empty()
                  ? "all readable"
                  : Format("%zu more are damaged", damaged.size()).c_str());
  std::printf(
      "decoding    %.1f frames/s with %d thread(s), %.2f ms per frame median\n",
      frames / SecondsSince(start), threads, Median(decode_ms));
  return kExitOk;
}

int Main(const RunSettings& settings, const ProgramInfo& info) {
  const auto start = std::chrono::steady_clock::now();
  RequireFlag("dataset", settings.sequence.dataset);
  const int threads = NumThreads(FLAGS_threads);

  // Check the input before the work starts and before anything is written.
  Sequence sequence = OpenSequence(settings.sequence, settings.wants_color());
  Warn(sequence.remarks);
  if (FLAGS_validate_only) return ValidateOnly(sequence, threads);
  SequenceRun run(settings.odometry, sequence.source->camera(),
                  sequence.inputs);
  return TrackAndWrite(settings, info, start, &sequence, &run);
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info, rgbd_pose::Main);
}
