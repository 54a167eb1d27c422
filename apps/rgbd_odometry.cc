// Estimates the camera motion of an RGB-D sequence.

#include <gflags/gflags.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "apps/export/export_format.h"
#include "apps/pipeline/sequence.h"
#include "apps/report/report_page.h"
#include "apps/results/run_output.h"
#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "apps/view/live_view.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/quantile.h"

DEFINE_int32(threads, 0,
             "threads that read images ahead and track; 0: one for each core; "
             "the result does not depend on it");
DEFINE_bool(validate_only, false,
            "only read every image and print the speed; needs no --output");
DEFINE_bool(report, true, "write OUTPUT/report.html");

namespace rgbd_pose {
namespace {

struct ProgramSettings {
  SequenceSettings sequence;
  OdometrySettings odometry;
  RunOutputSettings output;
  ViewSettings view;
};

ProgramInfo Info(ProgramSettings* settings) {
  return {"rgbd_odometry",
          "estimates the motion of an RGB-D camera along a sequence.",
          "rgbd_odometry --dataset=rgbd_dataset_freiburg1_xyz --camera=tum_fr1 "
          "--output=runs/fr1_xyz",
          {{"Run", {"report", "validate_only", "finish_on_signal", "threads"}}},
          {SettingTable(&settings->sequence), SettingTable(&settings->odometry),
           SettingTable(&settings->output), SettingTable(&settings->view)}};
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

int Main(const ProgramSettings& settings, const ProgramInfo& info) {
  const auto start = std::chrono::steady_clock::now();
  RequireFlag("dataset", settings.sequence.dataset);
  if (!FLAGS_validate_only) RequireFlag("output", settings.output.output);
  const int threads = NumThreads(FLAGS_threads);

  // Check the input before the work starts and before anything is written.
  const bool keep_color = !settings.output.save_cloud.empty();
  Sequence sequence = OpenSequence(settings.sequence, keep_color);
  FrameSource& source = *sequence.source;
  Warn(sequence.remarks);
  if (FLAGS_validate_only) return ValidateOnly(sequence, threads);
  SequenceRun run(settings.odometry, source.camera().camera, sequence.inputs);
  RequireMeshFrames(settings.output, settings.sequence.dataset);
  RunOutput output(settings.output, source, settings.odometry.features.depth);

  LiveView view(settings.sequence.dataset, settings.view,
                source.camera().camera, run);
  if (view.is_open()) {
    std::fprintf(stderr, "view on     %s\n", view.address().c_str());
  }

  const std::string stopped =
      TrackSource(&source, threads, &run, &output,
                  [&view](const Frame& frame, const auto& is_interrupted) {
                    return view.Add(frame, is_interrupted);
                  });
  const double seconds = SecondsSince(start);

  const RunResults results = run.Finish(sequence.GroundTruth());
  std::string text =
      output.Write(results, threads, seconds, sequence.GroundTruth(),
                   settings.sequence.dataset, info, {{"stopped", stopped}});
  std::string no_report;
  if (FLAGS_report) {
    text += WriteRunPage(output.folder().staging_dir(), settings.output.output,
                         &no_report);
  }
  output.folder().Publish();
  text += SaveMesh(settings.output, threads);
  std::printf("%sresults in  %s\n", text.c_str(),
              settings.output.output.c_str());
  view.Finish(settings.output.output);
  return ExitCodeOf(info.name, results, settings.output.output, stopped,
                    no_report);
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info, rgbd_pose::Main);
}
