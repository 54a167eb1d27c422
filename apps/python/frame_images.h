#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "apps/python/arrays.h"
#include "apps/python/released_gil.h"
#include "core/geometry/camera.h"
#include "core/util/text_file.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Makes a frame with copies of the Python images (see Odometry.track). Copies
// are needed because frontends keep the image of a reference, while camera
// drivers overwrite their memory with the next image. The shutter times are
// those of `camera`. Throws InputError for images of a wrong shape or type.
Frame FrameFromArrays(const pybind11::object& image,
                      const pybind11::object& depth, const RgbdCamera& camera);

// Implements Odometry.track and Slam.track.
template <typename Shared>
auto TrackArrays(Shared* shared, const pybind11::object& image,
                 const pybind11::object& depth, std::optional<double> timestamp,
                 const pybind11::object& motion_guess, double depth_delay) {
  Frame frame = FrameFromArrays(image, depth, shared->camera());
  frame.depth_delay = depth_delay;
  std::optional<Rigid3d> guess;
  if (!motion_guess.is_none()) {
    guess = RigidFromArray(motion_guess, "motion_guess");
  }
  const ReleasedGil no_gil;
  return shared->Track(std::move(frame), timestamp, guess);
}

// Binds what Odometry and Slam share: track, trajectory, save_trajectory.
template <typename Shared>
void BindTracking(pybind11::class_<Shared>* type, const char* track_help,
                  const char* trajectory_help) {
  namespace py = pybind11;
  const auto trajectory = [](Shared* self) {
    const ReleasedGil no_gil;
    return self->trajectory();
  };
  type->def("track", &TrackArrays<Shared>, track_help, py::arg("image"),
            py::arg("depth"), py::arg("timestamp") = py::none(),
            py::arg("motion_guess") = py::none(), py::arg("depth_delay") = 0.0)
      .def_property_readonly(
          "trajectory",
          [=](Shared* self) { return ArraysFromTrajectory(trajectory(self)); },
          trajectory_help)
      .def(
          "save_trajectory",
          [=](Shared* self, const py::object& path) {
            WriteFileAtomically(PathFrom(path),
                                FormatTrajectory(trajectory(self)));
          },
          "Writes the trajectory as TUM text.", py::arg("path"));
}

// A read-only array on an image without a copy. It keeps `owner` alive.
template <typename T>
pybind11::array ArrayOfImage(const cv::Mat& image, pybind11::handle owner) {
  return ReadOnly(
      pybind11::array(pybind11::dtype::of<T>(), {image.rows, image.cols},
                      {image.step[0], image.step[1]}, image.data, owner));
}

}  // namespace rgbd_pose
