#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/released_gil.h"
#include "apps/python/setting_arguments.h"
#include "apps/view/live_view.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/frame.h"
#include "frontend/settings/settings.h"
#include "frontend/slam/sequence_run.h"

namespace rgbd_pose {

// What a tracked frame shows of itself: number, status, reason, matches.
std::string FrameInWords(const TrackedFrame& frame);

// Makes a frame with copies of the Python images (see Odometry.track):
// frontends keep images, while camera drivers overwrite theirs. Warns of depths
// that cannot be metres. Throws InputError for images of a wrong shape or type.
Frame FrameFromArrays(const pybind11::object& image,
                      const pybind11::object& depth, const RgbdCamera& camera);

// Samples of an inertial sensor from an array (N, 7), see Recording.imu. Throws
// InputError for another shape.
std::vector<ImuSample> ImuSamplesFrom(const pybind11::object& array);

// A run for several threads. Calls wait for each other and therefore must not
// hold the GIL. Keeps the results of all frames.
class SharedRun {
 public:
  const RgbdCamera& camera() const { return camera_; }

  bool HasFrames() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return !run_.frames().empty();
  }

  // The current poses of the frames that were not lost.
  Trajectory trajectory() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return run_.Path();
  }

  // See Odometry::UseImu. Throws InputError after the first frame.
  void UseImu(const ImuSensor& sensor);
  // See Odometry::AddImu. Throws InputError before UseImu.
  void AddImu(const std::vector<ImuSample>& samples);

  // Opens a page that shows the run, in place of an earlier one, and returns
  // its address. Throws InputError for invalid settings.
  std::string OpenView(const std::string& title, const ViewSettings& settings);
  // Ends the page; its last news remain in open browsers.
  void CloseView();
  // Whether the stop button of the page was pressed.
  bool IsStopped();

 protected:
  SharedRun(const RgbdCamera& camera, SequenceRun run)
      : camera_(camera), run_(std::move(run)) {}

  // Call with mutex_ locked. Without a timestamp, frames are 1/30 s apart. If
  // time does not increase, throws InputError and changes nothing.
  void Add(Frame frame, std::optional<double> timestamp, const Rigid3d* guess);

  const RgbdCamera camera_;
  std::mutex mutex_;
  SequenceRun run_;
  bool uses_imu_ = false;
  std::unique_ptr<LiveView> view_;  // null: no page
};

struct LivePage {
  SharedRun* tracker = nullptr;
  std::string address;
};

// Defines what Odometry and Slam share: the constructor Type(Settings,
// RgbdCamera), track, use_imu, add_imu, trajectory, save_trajectory, view.
// Type: a SharedRun.
template <typename Type, typename Settings>
pybind11::class_<Type> BindTracker(pybind11::module_* module, const char* name,
                                   const std::string& help,
                                   const char* track_help,
                                   const char* trajectory_help) {
  namespace py = pybind11;
  Settings defaults;
  const std::vector<Setting> table = SettingTable(&defaults);
  py::class_<Type> type(*module, name, (help + HelpOf(table)).c_str());
  const auto make = [name](const RgbdCamera& camera,
                           const std::string& frontend,
                           const py::kwargs& keywords) {
    Settings settings;
    const std::vector<Setting> rows = SettingTable(&settings);
    SetFromKeywords(name, py::dict(py::arg("frontend") = frontend), rows);
    SetFromKeywords(name, keywords, rows);
    return std::make_unique<Type>(settings, camera);
  };
  {
    // The settings are keyword-only, except for the frontend.
    const std::string signature =
        "__init__(self: rgbd_pose." + std::string(name) +
        ", camera: rgbd_pose.Camera, " +
        ArgumentsOf({*FindNamed(table, "frontend")}) + ", *, " +
        ArgumentsOf(WithoutRow("frontend", table)) +
        ") -> None\n\nRaises InputError for unknown names and invalid values.";
    py::options options;
    options.disable_function_signatures();
    type.def(py::init(make), signature.c_str(), py::arg("camera").none(false),
             py::arg("frontend") = OdometrySettings().frontend);
  }
  const auto has_frames = [](Type* self) {
    const ReleasedGil no_gil;
    return self->HasFrames();
  };
  const auto track = [=](Type* self, const py::object& image,
                         const py::object& depth,
                         std::optional<double> timestamp,
                         const py::object& motion_guess, double depth_delay) {
    Frame frame = FrameFromArrays(image, depth, self->camera());
    frame.depth_delay = depth_delay;
    std::optional<Rigid3d> guess;
    if (!motion_guess.is_none()) {
      guess = RigidFromArray(motion_guess, "motion_guess");
    }
    if (!has_frames(self)) {
      WarnUser(self->camera().camera.SanityWarning());
      WarnUser(DepthScaleWarning(frame));
    }
    const ReleasedGil no_gil;
    return self->Track(std::move(frame), timestamp,
                       guess.has_value() ? &*guess : nullptr);
  };
  const auto trajectory = [](Type* self) {
    const ReleasedGil no_gil;
    return self->trajectory();
  };
  const auto view = [name](Type* self, int port, double speed) {
    const ReleasedGil no_gil;
    return LivePage{self, self->OpenView(name, {true, port, speed})};
  };
  const auto get = [=](Type* self) {
    return ArraysFromTrajectory(trajectory(self));
  };
  const auto save = [=](Type* self, const py::object& path) {
    WriteFileAtomically(PathFrom(path), FormatTrajectory(trajectory(self)));
  };
  type.def("track", track, track_help, py::arg("image"), py::arg("depth"),
           py::arg("timestamp") = py::none(),
           py::arg("motion_guess") = py::none(), py::arg("depth_delay") = 0.0);
  type.def(
      "use_imu",
      [](Type* self, const py::object& cam_from_imu, double delay,
         bool has_gyro) {
        ImuSensor sensor;
        sensor.calibration.cam_from_imu =
            RigidFromArray(cam_from_imu, "cam_from_imu");
        sensor.calibration.delay_s = delay;
        sensor.has_gyro = has_gyro;
        const ReleasedGil no_gil;
        self->UseImu(sensor);
      },
      "Says what is known of an inertial sensor beside the camera, before the "
      "first frame:\ncam_from_imu (4, 4), m, turns its axes into those of the "
      "camera; delay: of its stamps\nafter the camera's, s. A gyroscope helps "
      "to track as long as images confirm it.",
      py::arg("cam_from_imu"), py::arg("delay") = 0.0,
      py::arg("has_gyro") = true);
  type.def(
      "add_imu",
      [](Type* self, const py::object& samples) {
        const std::vector<ImuSample> all = ImuSamplesFrom(samples);
        const ReleasedGil no_gil;
        self->AddImu(all);
      },
      "Adds samples of that sensor, (N, 7) as Recording.imu() has them, in "
      "order. Those up\nto the last row of a frame are needed before it is "
      "tracked. One that is not finite\nor not later than the one before is "
      "left out. Raises InputError before use_imu.",
      py::arg("samples"));
  type.def_property_readonly("trajectory", get, trajectory_help);
  type.def(
      "view", view,
      "Opens a page on this machine that shows the run live, from its "
      "first frame on, in\nplace of an earlier page. Returns its LivePage. "
      "track() waits while the page's\nbutton Pause is active. port: 0: any "
      "free one. speed: at most, as a multiple of\nreal time; 0: no limit. "
      "Raises InputError if the port is taken, or if the module was\nbuilt "
      "without cpp-httplib.",
      py::arg("port") = 0, py::arg("speed") = 0.0, py::keep_alive<0, 1>());
  type.def("save_trajectory", save, "Writes the trajectory as TUM text.",
           py::arg("path"));
  return type;
}

}  // namespace rgbd_pose
