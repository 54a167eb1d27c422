// The Python module: the functions of the C++ library with NumPy arrays.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <exception>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "core/geometry/camera.h"
#include "core/util/input_error.h"
#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "robust/m_estimator.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// Raises InputError in Python; its message may have a path that is not UTF-8.
void BindInputError(py::module_* module) {
  static const py::handle type =
      py::exception<InputError>(*module, "InputError", PyExc_ValueError)
          .release();
  type.attr("__doc__") =
      "Bad input. The message is one line: what is wrong, where, what to do.";
  // NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11 asks for it.
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown != nullptr) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      PyErr_SetObject(type.ptr(), TextOf(error.what()).ptr());
    }
  });
}

// Lets pickle.dumps(object, 0) and 1 work, or say what cannot be pickled: they
// would call a base class of pybind11, which ends the process. All classes of
// the module use protocol 2 instead.
void RequirePickleProtocol2(const py::module_& module) {
  const py::object reduce =
      py::module_::import("builtins").attr("object").attr("__reduce_ex__");
  const auto reduce_ex = [reduce](const py::object& self, int protocol) {
    return reduce(self, std::max(protocol, 2));
  };
  for (const auto& [name, item] : module.attr("__dict__").cast<py::dict>()) {
    // Exceptions are Python's own.
    if (!py::isinstance<py::type>(item) || PyExceptionClass_Check(item.ptr())) {
      continue;
    }
    py::setattr(item, "__reduce_ex__",
                py::cpp_function(reduce_ex, py::name("__reduce_ex__"),
                                 py::is_method(item), py::arg("protocol")));
  }
}

}  // namespace
}  // namespace rgbd_pose

PYBIND11_MODULE(_rgbd_pose, m) {
  using namespace rgbd_pose;
  // Messages and help name the package that users import, not this module.
  const py::object own_name = m.attr("__name__");
  m.attr("__name__") = "rgbd_pose";
  m.attr("__version__") = RGBD_POSE_VERSION;
  BindInputError(&m);
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
  RequirePickleProtocol2(m);
  m.attr("__name__") = own_name;
}
