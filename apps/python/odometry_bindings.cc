#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <vector>

#include "apps/pipeline/settings.h"
#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/frame_images.h"
#include "apps/python/pickling.h"
#include "apps/python/released_gil.h"
#include "apps/python/setting_arguments.h"
#include "apps/python/shared_slam.h"
#include "core/evaluation/trajectory.h"
#include "core/util/text_file.h"
#include "frontend/sources/tum_dataset.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

std::unique_ptr<SharedOdometry> MakeSharedOdometry(const RgbdCamera& camera,
                                                   const std::string& frontend,
                                                   const py::kwargs& keywords) {
  OdometrySettings settings;
  settings.frontend = frontend;
  SetFromKeywords("Odometry", keywords, SettingTable(&settings));
  return std::make_unique<SharedOdometry>(settings, camera);
}

std::string FrameInWords(const TrackedFrame& frame) {
  std::string text = "TrackedFrame(" + std::to_string(frame.index) + ": " +
                     ToString(frame.status);
  if (!frame.reason.empty()) text += ", " + frame.reason;
  return text + ", " + std::to_string(frame.inliers) + " of " +
         std::to_string(frame.matches) + " matches agree)";
}

void BindTrackedFrame(py::module_* module) {
  py::class_<RelativePose>(
      *module, "RelativePose",
      "A measured motion between two frames, by their index.")
      .def_readonly("ref", &RelativePose::ref, "index of the reference")
      .def_readonly("cur", &RelativePose::cur, "index of the frame")
      .def_property_readonly(
          "cur_from_ref", Get(&RelativePose::cur_from_ref),
          "(4, 4): point_in_cur = cur_from_ref @ point_in_ref (m)")
      .def_property_readonly("covariance", Get(&RelativePose::covariance),
                             "(6, 6), as that of MotionEstimate")
      .def(Pickled<RelativePose>());
  py::class_<TrackedFrame>(*module, "TrackedFrame",
                           "The tracking result of one frame.")
      .def_readonly("index", &TrackedFrame::index, "index of the frame, from 0")
      .def_readonly("timestamp", &TrackedFrame::timestamp, "s")
      .def_property_readonly(
          "status", Get(&TrackedFrame::status),
          "'ok', 'degraded' (a pose, but from few or contradictory matches) "
          "or\n'lost' (no pose was found: see on_lost for the one reported)")
      .def_readonly("reason", &TrackedFrame::reason,
                    "reason of the status; empty if ok")
      .def_property_readonly(
          "world_from_cam", Get(&TrackedFrame::world_from_cam),
          "(4, 4): point_in_world = world_from_cam @ point_in_cam (m); the "
          "world\nis the camera of the first frame")
      .def_property_readonly(
          "covariance",
          [](const TrackedFrame& self) -> py::object {
            if (self.edges.empty()) return py::none();
            return ArrayFromMatrix(self.edges.front().covariance);
          },
          "(6, 6), of the motion since the reference frame: that of the first\n"
          "edge; None if there is none")
      .def_readonly(
          "edges", &TrackedFrame::edges,
          "list of RelativePose: the measured motions; the first gives the "
          "pose. If the\nreference changes to an earlier frame, a second one "
          "connects the frame to the\nprevious reference")
      .def_readonly("segment", &TrackedFrame::segment,
                    "relative poses are known only within a segment")
      .def_readonly("reference", &TrackedFrame::reference,
                    "index of its reference frame; -1: none")
      .def_readonly("is_reference", &TrackedFrame::is_reference,
                    "whether it became the reference of later frames")
      .def_readonly("previous_is_reference",
                    &TrackedFrame::previous_is_reference,
                    "whether the previous frame became the reference for it")
      .def_readonly("relocalised", &TrackedFrame::relocalised,
                    "whether it was relocalised among earlier references")
      .def_readonly("is_predicted", &TrackedFrame::is_predicted,
                    "whether it is lost, but its pose follows motion_guess")
      .def_property_readonly(
          "tracking_source", Get(&TrackedFrame::source),
          "source of its motion: 'features', 'direct' (pixels),\n"
          "'features+direct', or '' if it has none")
      .def_readonly("matches", &TrackedFrame::matches,
                    "number of matches (features or pixels) with the reference")
      .def_readonly("inliers", &TrackedFrame::inliers,
                    "number of inliers among these")
      .def_readonly("iterations", &TrackedFrame::iterations,
                    "solver iterations")
      .def_readonly("sigma", &TrackedFrame::sigma,
                    "spread of the whitened residuals, ideally 1")
      .def_readonly("track_ms", &TrackedFrame::track_ms,
                    "total time of tracking, ms")
      .def_readonly("match_ms", &TrackedFrame::match_ms,
                    "part of track_ms: matching")
      .def_readonly("solve_ms", &TrackedFrame::solve_ms,
                    "part of track_ms: motion estimation")
      .def_readonly("reference_ms", &TrackedFrame::reference_ms,
                    "part of track_ms: features of a new reference")
      .def_readonly("relocalise_ms", &TrackedFrame::relocalise_ms,
                    "part of track_ms: relocalisation when lost")
      .def("__repr__", &FrameInWords)
      .def(Pickled<TrackedFrame>());
}

void BindSharedOdometry(py::module_* module) {
  OdometrySettings settings;
  const std::string doc = R"(
Tracks a camera frame by frame against a reference frame. Calls of one object
from several threads wait for each other; objects do not share anything.

)" + HelpOf(SettingTable(&settings));
  py::class_<SharedOdometry> odometry(*module, "Odometry", doc.c_str());
  DefineInit(&odometry, &MakeSharedOdometry, "Odometry", settings.frontend,
             SettingTable(&settings));
  BindTracking(&odometry, R"(
Tracks the next frame. The GIL is released.

image: (height, width) uint8 grey, or (height, width, 3) uint8 in the order red,
    green, blue.
depth: (height, width), registered to the image: uint16 in raw units
    (camera.depth_scale per metre; 0 and 65535: none), or float32 or float64 in
    metres (not finite or not positive: none), which are stored in steps of
    0.2 mm up to 13.1 m.
timestamp: s, later than that of the previous frame; None: 1/30 s after it.
motion_guess: (4, 4) cur_from_prev since the previous frame, from another
    sensor; tried first, but used only if the images agree with it.
depth_delay: time from the image to the depth measurement, s.

Both arrays are copied. A lost frame is reported by its status; images of a
wrong shape or type raise InputError and are not counted as frames.)",
               "(timestamps (N,), world_from_cam (N, 4, 4)) of frames not "
               "lost");
}

}  // namespace

void BindOdometry(py::module_* module) {
  BindTrackedFrame(module);
  BindSharedOdometry(module);
}

}  // namespace rgbd_pose
