#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/pickling.h"
#include "core/geometry/camera.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "frontend/files/camera_file.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

RgbdCamera Checked(const RgbdCamera& camera) {
  RequireSound(camera.camera.Check(), "Camera: ");
  if (!std::isfinite(camera.depth_scale) || camera.depth_scale <= 0.0) {
    throw InputError("Camera: the depth scale must be a positive number");
  }
  for (const ShutterParameter& parameter : kShutterParameters) {
    // The negated condition also rejects NaN.
    if (!(std::abs(camera.*parameter.image.*parameter.value) <=
          parameter.most)) {
      throw InputError("Camera: " + std::string(parameter.name) +
                       " must be at most " + ShortNumber(parameter.most) +
                       " s");
    }
  }
  return camera;
}

RgbdCamera MakeCamera(double fx, double fy, double cx, double cy, int width,
                      int height, const std::vector<double>& distortion,
                      double depth_scale, double color_time_offset,
                      double color_readout, double depth_time_offset,
                      double depth_readout, const std::string& lens) {
  RgbdCamera result;
  result.depth_scale = depth_scale;
  result.color_shutter = {color_time_offset, color_readout};
  result.depth_shutter = {depth_time_offset, depth_readout};
  Camera& camera = result.camera;
  camera = {width, height, fx, fy, cx, cy};
  const bool is_equidistant = lens == "equidistant";
  if (!is_equidistant && lens != "rational") {
    throw InputError("Camera: lens '" + lens +
                     "' is neither 'rational' nor 'equidistant'");
  }
  if (is_equidistant) camera.lens_model = LensModel::kEquidistant;
  if (!distortion.empty() &&
      !camera.SetDistortion(camera.lens_model, distortion)) {
    throw InputError("Camera: " + std::to_string(distortion.size()) +
                     " distortion coefficients; " +
                     (is_equidistant ? "an equidistant lens has k1 k2 k3 k4"
                                     : "a rational lens has k1 k2 p1 p2, "
                                       "optionally k3 or k3 k4 k5 k6"));
  }
  return Checked(result);
}

RgbdCamera LoadCamera(const py::object& path_or_preset,
                      std::optional<double> depth_scale) {
  const CameraSetup setup =
      ResolveCameraSetup(PathFrom(path_or_preset), "cam0");
  WarnUser(setup.remark);
  RgbdCamera camera = RegisteredCamera(setup);
  if (depth_scale.has_value()) camera.depth_scale = *depth_scale;
  return Checked(camera);
}

py::array Intrinsics(const RgbdCamera& camera) {
  const Camera& c = camera.camera;
  return ArrayFromMatrix(
      Eigen::Matrix3d{{c.fx, 0.0, c.cx}, {0.0, c.fy, c.cy}, {0.0, 0.0, 1.0}});
}

std::string CameraInWords(const RgbdCamera& camera) {
  const Camera& c = camera.camera;
  std::string words = Format(
      "Camera(fx=%.9g, fy=%.9g, cx=%.9g, cy=%.9g, width=%d, height=%d, "
      "distortion=(",
      c.fx, c.fy, c.cx, c.cy, c.width, c.height);
  const char* comma = "";
  for (const double coefficient : c.Distortion()) {
    words += comma + Format("%.9g", coefficient);
    comma = ", ";
  }
  words += Format("), depth_scale=%.9g", camera.depth_scale);
  if (c.lens_model == LensModel::kEquidistant) words += ", lens='equidistant'";
  for (const ShutterParameter& parameter : kShutterParameters) {
    const double value = camera.*parameter.image.*parameter.value;
    if (value == 0.0) continue;
    words += ", " + std::string(parameter.name) + "=" + ShortNumber(value);
  }
  return words + ")";
}

// A getter for a member of the pinhole model.
template <auto kMember>
auto Of(const RgbdCamera& camera) {
  return camera.camera.*kMember;
}

}  // namespace

void BindCamera(py::module_* module) {
  py::class_<RgbdCamera> camera(*module, "Camera", R"(
A pinhole camera with the scale and timing of its images. It is immutable.

Axes are optical: x right, y down, z forward. Pixel (0, 0) is the centre of the
upper left pixel. Focal lengths and centre are in pixels. The distortion is that
of OpenCV: k1 k2 p1 p2, optionally k3 or k3 k4 k5 k6; with lens='equidistant'
(fisheye) k1 k2 k3 k4. depth_scale is raw units of a depth image per metre.

A row r of the colour image is exposed color_time_offset + color_readout *
((r + 1/2) / height - 1/2) seconds after the image's time stamp; depth likewise,
after its own.)");
  camera.def(py::init(&MakeCamera), "Raises InputError for invalid values.",
             py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"),
             py::arg("width") = 640, py::arg("height") = 480,
             py::arg_v("distortion", std::vector<double>(), "()"),
             py::arg("depth_scale") = 5000.0,
             py::arg("color_time_offset") = 0.0, py::arg("color_readout") = 0.0,
             py::arg("depth_time_offset") = 0.0, py::arg("depth_readout") = 0.0,
             py::arg("lens") = "rational");
  camera.def_static("load", &LoadCamera, R"(
A camera by the name of a preset (camera_presets()) or a YAML file in the layout
of ORB-SLAM2/3, ROS camera_info or Kalibr. depth_scale, if given, replaces that
of the preset or file.)",
                    py::arg("path_or_preset"),
                    py::arg("depth_scale") = py::none());
  const auto property = PropertiesOf(&camera);
  property("fx", &Of<&Camera::fx>, "px");
  property("fy", &Of<&Camera::fy>, "px");
  property("cx", &Of<&Camera::cx>, "px");
  property("cy", &Of<&Camera::cy>, "px");
  property("width", &Of<&Camera::width>, "px");
  property("height", &Of<&Camera::height>, "px");
  property(
      "distortion",
      [](const RgbdCamera& self) {
        return py::tuple(py::cast(self.camera.Distortion()));
      },
      "k1 k2 p1 p2 k3, and k4 k5 k6 if not 0; for a fisheye k1 k2 k3 k4");
  property(
      "lens",
      [](const RgbdCamera& self) {
        return self.camera.lens_model == LensModel::kEquidistant ? "equidistant"
                                                                 : "rational";
      },
      "'rational' (includes plumb bob) or 'equidistant'");
  property("depth_scale", &RgbdCamera::depth_scale,
           "raw units of a depth image per metre");
  property("matrix", &Intrinsics, "(3, 3) [fx 0 cx; 0 fy cy; 0 0 1], px");
  camera.def("__repr__", &CameraInWords).def(Pickled<RgbdCamera>());
  for (const ShutterParameter& parameter : kShutterParameters) {
    const auto get = [parameter](const RgbdCamera& self) {
      return self.*parameter.image.*parameter.value;
    };
    property(parameter.name, get, "s");
  }
}

}  // namespace rgbd_pose
