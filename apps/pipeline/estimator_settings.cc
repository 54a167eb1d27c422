#include "apps/pipeline/estimator_settings.h"

#include "core/util/named_values.h"
#include "robust/scale.h"

namespace rgbd_pose {
namespace {

constexpr Named<Assembly> kAssemblies[] = {
    {"compressed", Assembly::kCompressed},
    {"per_match", Assembly::kPerMatch},
    {"autodiff", Assembly::kAutodiff},
};

constexpr Named<RobustSchedule> kRobustSchedules[] = {
    {"gnc", RobustSchedule::kGnc},
    {"direct", RobustSchedule::kDirect},
};

}  // namespace

std::vector<std::string> AssemblyNames() { return NamesOf(kAssemblies); }

std::vector<std::string> RobustScheduleNames() {
  return NamesOf(kRobustSchedules);
}

EstimatorOptions MakeEstimatorOptions(const EstimatorSettings& settings) {
  EstimatorOptions options;
  options.assembly = ValueOf(kAssemblies, "assembly", settings.assembly);
  options.schedule =
      ValueOf(kRobustSchedules, "robust schedule", settings.robust_schedule);
  const ScaleEstimator* scale = FindScaleEstimator(settings.scale);
  if (scale == nullptr) {
    throw UnknownName("scale", settings.scale, ScaleEstimatorNames());
  }
  options.scale = scale->estimate;
  return options;
}

const DepthNoiseModel* DepthNoiseByName(const std::string& name) {
  const DepthNoiseModel* model = FindDepthNoiseModel(name);
  if (model == nullptr) {
    throw UnknownName("depth noise", name, DepthNoiseModelNames());
  }
  return model;
}

}  // namespace rgbd_pose
