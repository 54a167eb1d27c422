#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/pickling.h"
#include "apps/python/released_gil.h"
#include "core/evaluation/alignment.h"
#include "core/evaluation/evaluation.h"
#include "core/evaluation/trajectory.h"
#include "core/util/format.h"
#include "core/util/text_file.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// Individual errors and their statistics.
struct Errors : ErrorStatistics {
  std::vector<double> values;
};

struct AteResult : Errors {
  std::vector<double> timestamps;
  Rigid3d reference_from_estimated;
};

struct RpeResult {
  std::vector<double> timestamps;
  Errors translation;
  Errors rotation;
};

void EachField(PickledBytes* bytes, Errors& errors) {
  (*bytes)(static_cast<ErrorStatistics&>(errors), errors.values);
}
void EachField(PickledBytes* bytes, AteResult& ate) {
  (*bytes)(static_cast<Errors&>(ate), ate.timestamps,
           ate.reference_from_estimated);
}
void EachField(PickledBytes* bytes, RpeResult& rpe) {
  (*bytes)(rpe.timestamps, rpe.translation, rpe.rotation);
}

EvaluationReport EvaluateObjects(const py::object& estimated,
                                 const py::object& reference,
                                 const EvaluationOptions& options) {
  const Trajectory estimate = TrajectoryFrom(estimated, "estimated");
  const Trajectory truth = TrajectoryFrom(reference, "reference");
  const ReleasedGil no_gil;
  return Evaluate(estimate, truth, options);
}

AteResult EvaluateAte(const py::object& estimated, const py::object& reference,
                      double max_time_difference) {
  // This value is not used here, but it must exceed the time difference.
  const double delta_seconds = 2.0 * max_time_difference + 1.0;
  const EvaluationReport report = EvaluateObjects(
      estimated, reference, {max_time_difference, delta_seconds});
  WarnUser(Sim3Warning(report.sim3, report.ate.rmse));
  AteResult result{{report.ate, {}}, {}, report.truth_from_estimate};
  for (const PoseError& pose : report.poses) {
    result.timestamps.push_back(pose.timestamp);
    result.values.push_back(pose.position);
  }
  return result;
}

RpeResult EvaluateRpe(const py::object& estimated, const py::object& reference,
                      double delta_seconds, double max_time_difference) {
  const EvaluationReport report = EvaluateObjects(
      estimated, reference, {max_time_difference, delta_seconds});
  const auto& [translation, rotation] = report.rpe_seconds;
  RpeResult result{{}, {translation, {}}, {rotation, {}}};
  for (const PoseError& pose : report.poses) {
    if (!pose.rpe_translation.has_value()) continue;
    result.timestamps.push_back(pose.timestamp);
    result.translation.values.push_back(*pose.rpe_translation);
    result.rotation.values.push_back(*pose.rpe_rotation);
  }
  return result;
}

std::string ErrorsInWords(const char* name, const Errors& errors) {
  return Format("%s(rmse=%.6g, max=%.6g, count=%d)", name, errors.rmse,
                errors.max, static_cast<int>(errors.count));
}

void BindErrors(py::module_* module) {
  py::class_<Errors> errors(*module, "Errors",
                            "Errors (m or rad): statistics, which are 0 if "
                            "there are no errors, and values.");
  const auto property = PropertiesOf(&errors);
  property("count", &Errors::count, "number of errors");
  property("rmse", &Errors::rmse, "root mean square");
  property("mean", &Errors::mean, "mean");
  property("median", &Errors::median,
           "median; for an even count the mean of the two middle ones");
  property("max", &Errors::max, "maximum");
  property("values", &ViewOf<Errors, &Errors::values>,
           "(count,), in the order of time");
  errors.def("__repr__",
             [](const Errors& self) { return ErrorsInWords("Errors", self); });
  errors.def(Pickled<Errors>());
}

void BindAteResult(py::module_* module) {
  py::class_<AteResult, Errors> result(
      *module, "AteResult",
      "Absolute trajectory error: distances (m) of positions after the best "
      "rigid\nalignment, without scale.");
  const auto property = PropertiesOf(&result);
  property("timestamps", &ViewOf<AteResult, &AteResult::timestamps>,
           "(count,), of the estimated poses, s");
  property("reference_from_estimated", &AteResult::reference_from_estimated,
           "(4, 4), the rigid alignment");
  result.def("__repr__", [](const AteResult& self) {
    return ErrorsInWords("AteResult", self);
  });
  result.def(Pickled<AteResult>());
}

void BindRpeResult(py::module_* module) {
  py::class_<RpeResult> result(
      *module, "RpeResult",
      "Relative pose errors of all motions over the interval.");
  const auto property = PropertiesOf(&result);
  property("translation", &RpeResult::translation, "Errors, m");
  property("rotation", &RpeResult::rotation, "Errors, rad");
  property("timestamps", &ViewOf<RpeResult, &RpeResult::timestamps>,
           "(count,), of the first pose of each interval, s");
  result.def("__repr__", [](const RpeResult& self) {
    return "RpeResult(translation=" +
           ErrorsInWords("Errors", self.translation) +
           ", rotation=" + ErrorsInWords("Errors", self.rotation) + ")";
  });
  result.def(Pickled<RpeResult>());
}

}  // namespace

void BindEvaluation(py::module_* module) {
  BindErrors(module);
  BindAteResult(module);
  BindRpeResult(module);
  const double difference = EvaluationOptions().max_time_difference;
  module->def("evaluate_ate", &EvaluateAte, R"(
Absolute trajectory error of an estimated trajectory.

estimated, reference: path of a TUM text file, or a pair of time stamps (N,) (s,
    increasing) and poses world_from_cam, (N, 7) tx ty tz qx qy qz qw or
    (N, 4, 4).
max_time_difference: maximum time difference of paired poses (s).

Warns of a size or shape that suggests a wrong depth scale, focal length or file.
Raises InputError if no poses can be paired.)",
              py::arg("estimated"), py::arg("reference"),
              py::arg("max_time_difference") = difference);
  module->def("evaluate_rpe", &EvaluateRpe, R"(
Relative pose error of an estimated trajectory over a fixed time.

delta_seconds: the interval; one starts at every pose that has a counterpart at
    its end. It must exceed max_time_difference.

All other arguments are those of evaluate_ate.)",
              py::arg("estimated"), py::arg("reference"),
              py::arg("delta_seconds") = EvaluationOptions().rpe_delta_seconds,
              py::arg("max_time_difference") = difference);
  module->def(
      "read_trajectory",
      [](const py::object& path) {
        return ArraysFromTrajectory(TrajectoryFrom(path, "path"));
      },
      "Reads (timestamps (N,), poses (N, 4, 4)) from a TUM text file.",
      py::arg("path"));
  module->def(
      "write_trajectory",
      [](const py::object& path, const py::object& trajectory) {
        WriteFileAtomically(PathFrom(path), FormatTrajectory(TrajectoryFrom(
                                                trajectory, "trajectory")));
      },
      "Writes a trajectory, given as in evaluate_ate, as TUM text.",
      py::arg("path"), py::arg("trajectory"));
}

}  // namespace rgbd_pose
