// Converts any recording to a TUM RGB-D folder.

#include <gflags/gflags.h>

#include <cstdio>
#include <string>

#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "apps/shell/stop_signal.h"
#include "frontend/settings/sequence.h"
#include "frontend/sources/tum_writer.h"

DEFINE_string(output, "", "folder to create, in TUM RGB-D layout");
DEFINE_int32(threads, 0,
             "threads that read and write images; 0: one for each core; the "
             "result does not depend on it");

namespace rgbd_pose {
namespace {

ProgramInfo Info(SequenceSettings* settings) {
  return {
      "rgbd_convert",
      "writes a recording of any kind, or part of it, as a TUM RGB-D folder.",
      "rgbd_convert --dataset=scene0000_00 --output=scene_tum",
      {{"Run", {"output", "threads"}}},
      {SettingTable(settings)}};
}

std::string SaidOfImu(const WrittenSequence& written) {
  if (written.imu_samples == 0) return "";
  return ", with " + std::to_string(written.imu_samples) + " inertial samples";
}

int Main(const SequenceSettings& settings, const ProgramInfo& info) {
  RequireFlag("dataset", settings.dataset);
  RequireFlag("output", FLAGS_output);
  Sequence sequence = OpenSequence(settings, /*keep_color=*/true);
  RequireOutside("output", FLAGS_output, settings.dataset);
  FrameSource& source = *sequence.source;
  Warn(sequence.remarks);
  TumWriterOptions writer;
  writer.threads = NumThreads(FLAGS_threads);
  writer.ground_truth = [&sequence] {
    const Trajectory* truth = sequence.GroundTruth();
    return truth == nullptr ? Trajectory() : *truth;
  };
  writer.truth_noise = sequence.inputs.truth_noise;
  writer.max_damaged = sequence.inputs.max_damaged;
  const StopSignal signal;
  writer.stop = [&signal] { return signal.name(); };
  WrittenSequence written;
  {
    ProgressBar bar("converting", static_cast<int>(source.timestamps().size()));
    writer.progress = [&](int done) { bar.Update(done); };
    written = WriteTumSequence(&source, FLAGS_output, writer);
  }
  Warn(DroppedFrames(source, written.damaged));
  Warn({written.remark});
  std::printf("%s: %d frames%s%s\n", FLAGS_output.c_str(), written.frames,
              sequence.GroundTruth() == nullptr ? "" : ", with ground truth",
              SaidOfImu(written).c_str());
  if (!written.stopped.empty()) {
    std::fprintf(stderr, "%s: stopped after %d frames (%s); they are in %s\n",
                 info.name.c_str(), written.frames, written.stopped.c_str(),
                 FLAGS_output.c_str());
    return kExitStopped;
  }
  return kExitOk;
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  return rgbd_pose::RunProgram(argc, argv, rgbd_pose::Info, rgbd_pose::Main);
}
