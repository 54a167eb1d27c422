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

// A frame with copies of the images that Python gave (see Odometry.track):
// frontends keep the image of a reference, and cameras write the next image
// into the same memory. Its rows were exposed as the camera says. Throws
// InputError for images of a wrong shape or type.
Frame FrameFromArrays(const pybind11::object& image,
                      const pybind11::object& depth, const RgbdCamera& camera);

// Odometry.track and Slam.track.
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

// What Odometry and Slam have in common: track, trajectory, save_trajectory.
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

// An image that an object holds, seen as an array that keeps it alive; no copy.
template <typename T>
pybind11::array ArrayOfImage(const cv::Mat& image, pybind11::handle owner) {
  return ReadOnly(
      pybind11::array(pybind11::dtype::of<T>(), {image.rows, image.cols},
                      {image.step[0], image.step[1]}, image.data, owner));
}

}  // namespace rgbd_pose
