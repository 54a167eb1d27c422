// Compares losses on whole sequences, simulated or recorded.

#include <algorithm>
#include <filesystem>

#include "apps/compare/compare_sequence.h"
#include "apps/compare/experiment.h"
#include "apps/shell/program.h"
#include "apps/shell/progress_bar.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/settings/sequence.h"
#include "frontend/simulation/synthetic_dataset.h"

namespace rgbd_pose {
namespace {

// Used by ORB-SLAM2 for freiburg2, whose depths it found to be 4 % too large.
constexpr double kOtherFr2DepthScale = 5208.0;
// A sequence compares nothing if all losses track a smaller share.
constexpr double kMinTrackedShare = 0.5;

// The last component of a path, which may end with a slash, usable in a table.
std::string FolderName(const std::string& path) {
  const std::filesystem::path folder =
      std::filesystem::absolute(path).lexically_normal() / "";
  std::string name = folder.parent_path().filename();
  std::replace(name.begin(), name.end(), '"', '\'');
  return name;
}

// Compares several sequences one after the other.
class SequenceExperiment {
 public:
  SequenceExperiment(const std::string& name,
                     const ExperimentSettings& settings,
                     const std::string& output)
      : settings_(settings),
        losses_(ChosenLosses(settings, {"none", "huber", "cauchy",
                                        "geman_mcclure", "welsch", "tukey"})),
        output_(output),
        report_("# M-estimators on " + name + "\n\nTracker " +
                settings.odometry.tracker + ", cost " +
                settings.odometry.estimator.cost + ", frontend " +
                settings.odometry.frontend + ".\n\n") {}

  void Add(const std::string& title, FrameSource* source,
           const std::optional<Trajectory>& truth, bool returns_to_start) {
    PrepareOutput(output_);
    const std::vector<LossRun> runs = Track(source, truth);
    std::vector<std::string> shares;
    for (const LossRun& run : runs) {
      shares.push_back(run.loss + Format(" %.1f", run.TrackedShare() * 100.0));
      any_tracked_ |= run.TrackedShare() >= kMinTrackedShare;
    }
    report_ += "## " + title + "\n\n" + stopped_;
    if (returns_to_start) {
      report_ +=
          "End pose compared with angle [0 0 0] and translation [0 0 0], as in "
          "the thesis' Tables 4.4-4.6:\n\n" +
          EndPoseTable(runs, returns_to_start) + "\n";
    }
    if (truth.has_value()) {
      report_ +=
          "Errors along the path (RMSE), as in the thesis' Tables 4.7 and "
          "4.8:\n\n" +
          PathErrorTable(runs);
    } else {
      report_ +=
          "There is no groundtruth.txt, so errors are unknown. Last pose "
          "relative to the first:\n\n" +
          EndPoseTable(runs, returns_to_start) +
          "\nFrames tracked (%): " + Join(shares) + ".\n";
    }
    report_ += "\n";
    tables_ += SequenceCsvRows(title, runs);
    paths_ += ComparedPathsCsvRows(title, ComparePaths(runs, truth));
  }

  ExperimentResult Finish() const {
    WriteOutput(output_, "tables.csv", tables_);
    WriteOutput(output_, "paths.csv", paths_);
    return {report_, any_tracked_, !stopped_.empty()};
  }

 private:
  // Tracks a sequence with all losses and otherwise equal settings.
  std::vector<LossRun> Track(FrameSource* source,
                             const std::optional<Trajectory>& truth) {
    OdometrySettings settings = settings_.odometry;
    std::vector<SequenceRun> runs;
    for (const std::string& loss : losses_) {
      settings.estimator.loss = loss;
      runs.emplace_back(settings, source->camera());
    }
    std::vector<SequenceRun*> all;
    for (SequenceRun& run : runs) all.push_back(&run);
    {
      ProgressBar bar("tracking",
                      static_cast<int>(source->timestamps().size()));
      const std::string stopped =
          TrackAll(source, AvailableCores(), all, [&bar](const Frame& frame) {
            bar.Update(frame.index + 1);
            return true;
          });
      Warn(DroppedFrames(*source, all[0]->damaged(),
                         all[0]->odometry().repeated()));
      if (!stopped.empty()) {
        Warn({"stopped early: " + stopped});
        stopped_ = "Stopped early: " + stopped + "\n\n";
      }
    }
    std::vector<LossRun> results;
    for (size_t i = 0; i < losses_.size(); ++i) {
      results.push_back(
          {runs[i].Finish(truth.has_value() ? &*truth : nullptr), losses_[i]});
    }
    return results;
  }

  const ExperimentSettings& settings_;
  const std::vector<std::string> losses_;
  const std::string& output_;
  std::string report_;
  std::string tables_ = std::string("sequence,loss,") + kSequenceFigures + "\n";
  std::string paths_ = std::string("sequence,loss,") + kPathColumns + "\n";
  bool any_tracked_ = false;  // by any loss, in any sequence
  std::string stopped_;       // why a sequence ended early; empty: none did
};

}  // namespace

ExperimentResult RunSimulated(const ExperimentSettings& settings,
                              const std::string& output) {
  const std::string& name = settings.experiment;
  SequenceExperiment experiment(name, settings, output);
  SyntheticOptions options;
  options.path = name;
  options.frames = settings.frames;
  options.camera =
      ResolveCamera(settings.camera.empty() ? "ros_default" : settings.camera);
  SyntheticDataset dataset(options);
  experiment.Add(
      "simulated " + name + ", " + std::to_string(settings.frames) + " frames",
      &dataset, dataset.ground_truth(),
      /*returns_to_start=*/name == "pan_tilt");
  return experiment.Finish();
}

// Runs once for each possible depth scale of the sequence.
ExperimentResult RunRecorded(const ExperimentSettings& settings,
                             const std::string& output) {
  const std::string name = FolderName(settings.experiment);
  SequenceExperiment experiment(name, settings, output);
  RequireFlag("camera", settings.camera);
  RequireOutside("output", output, settings.experiment);
  SequenceSettings files;
  files.dataset = settings.experiment;
  files.camera = settings.camera;
  std::vector<double> scales = {ResolveCamera(files.camera).depth_scale};
  if (files.camera == "tum_fr2") scales.push_back(kOtherFr2DepthScale);
  for (const double scale : scales) {
    files.depth_scale = scale;
    Sequence sequence = OpenSequence(files);
    const std::string units = Format("%.10g", scale);
    experiment.Add(name + ", " + units + " raw depth units per metre",
                   sequence.source.get(), sequence.ground_truth,
                   /*returns_to_start=*/false);
  }
  return experiment.Finish();
}

}  // namespace rgbd_pose
