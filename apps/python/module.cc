// The Python module: the functions of the C++ library with NumPy arrays.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "apps/python/bindings.h"
#include "core/geometry/camera.h"
#include "core/util/input_error.h"
#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "robust/m_estimator.h"

namespace py = pybind11;

PYBIND11_MODULE(_rgbd_pose, m) {
  using namespace rgbd_pose;
  // Messages and help name the package that users import, not this module.
  const py::object own_name = m.attr("__name__");
  m.attr("__name__") = "rgbd_pose";
  m.attr("__version__") = RGBD_POSE_VERSION;
  py::register_exception<InputError>(m, "InputError", PyExc_ValueError).doc() =
      "Bad input. The message is one line: what is wrong, where, what to do.";
  m.def("costs", CostNames, "Names of all costs.");
  m.def("losses", MEstimatorNames, "Names of all M-estimators.");
  m.def("frontends", FrontendNames, "Names of all frontends.");
  m.def("camera_presets", CameraPresetNames,
        "Names of the presets for Camera.load.");
  BindCamera(&m);
  BindEstimate(&m);
  BindPreintegration(&m);
  BindFactors(&m);
  BindProblem(&m);
  BindRecording(&m);
  BindOdometry(&m);
  BindSlam(&m);
  BindEvaluation(&m);
  BindExport(&m);
  BindCalibration(&m);
  m.attr("__name__") = own_name;
}
