#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/pickling.h"
#include "apps/python/released_gil.h"
#include "apps/python/tracker_bindings.h"
#include "core/util/format.h"
#include "core/util/units.h"
#include "frontend/settings/settings.h"
#include "frontend/tracking/tracked_frame.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

class SharedOdometry : public SharedRun {
 public:
  SharedOdometry(const OdometrySettings& settings, const RgbdCamera& camera)
      : SharedRun(camera, SequenceRun(settings, camera)) {}

  // See SharedRun::Add.
  TrackedFrame Track(Frame frame, std::optional<double> timestamp,
                     const Rigid3d* guess) {
    const std::lock_guard<std::mutex> lock(mutex_);
    Add(std::move(frame), timestamp, guess);
    return run_.frames().back();
  }
};

std::string MotionInWords(const RelativePose& pose) {
  const Rigid3d& motion = pose.cur_from_ref;
  return Format("RelativePose(%d to %d: %.4f m, %.3f degrees)", pose.ref,
                pose.cur, motion.translation.norm(),
                motion.Angle() * kDegreesPerRadian);
}

void BindRelativePose(py::module_* module) {
  py::class_<RelativePose> pose(
      *module, "RelativePose",
      "A measured motion between two frames, by their index.");
  const auto property = PropertiesOf(&pose);
  property("ref", &RelativePose::ref, "index of the reference");
  property("cur", &RelativePose::cur, "index of the frame");
  property("cur_from_ref", &RelativePose::cur_from_ref,
           "(4, 4): point_in_cur = cur_from_ref @ point_in_ref (m)");
  property("covariance", &RelativePose::covariance,
           "(6, 6), as that of MotionEstimate");
  pose.def("__repr__", &MotionInWords).def(Pickled<RelativePose>());
}

void BindTrackedFrame(py::module_* module) {
  py::class_<TrackedFrame> frame(*module, "TrackedFrame",
                                 "The tracking result of one frame.");
  const auto property = PropertiesOf(&frame);
  property("index", &TrackedFrame::index, "index of the frame, from 0");
  property("timestamp", &TrackedFrame::timestamp, "s");
  property("status", &TrackedFrame::status,
           "'ok', 'degraded' (a pose, but from few or contradictory matches) "
           "or\n'lost' (no pose was found: see on_lost for the one reported)");
  property("reason", &TrackedFrame::reason,
           "reason of the status; empty if ok");
  property("world_from_cam", &TrackedFrame::world_from_cam,
           "(4, 4): point_in_world = world_from_cam @ point_in_cam (m); the "
           "world\nis the camera of the first frame");
  property(
      "covariance",
      [](const TrackedFrame& self) -> py::object {
        if (self.edges.empty()) return py::none();
        return ArrayFromMatrix(self.edges.front().covariance);
      },
      "(6, 6), of the motion that gives the pose: that of the first edge;\n"
      "None if there is none");
  property("edges", &TrackedFrame::edges,
           "list of RelativePose: the measured motions; the first gives the "
           "pose. If the\nreference changes to an earlier frame, a second one "
           "connects the frame to the\nprevious reference");
  property("segment", &TrackedFrame::segment,
           "relative poses are known only within a segment");
  property("reference", &TrackedFrame::reference,
           "index of its reference frame; -1: none");
  property("is_reference", &TrackedFrame::is_reference,
           "whether it became the reference of later frames");
  property("previous_is_reference", &TrackedFrame::previous_is_reference,
           "whether the previous frame became a keyframe, mostly its "
           "reference");
  property("relocalised", &TrackedFrame::relocalised,
           "whether it was relocalised among earlier references");
  property("is_predicted", &TrackedFrame::is_predicted,
           "whether it is lost, but its pose follows motion_guess");
  property("tracking_source", &TrackedFrame::source,
           "source of its motion: 'features', 'direct' "
           "(pixels),\n'features+direct', or '' if it has none");
  property("matches", &TrackedFrame::matches,
           "number of matches (features or pixels) with the reference");
  property("inliers", &TrackedFrame::inliers, "number of inliers among these");
  property("iterations", &TrackedFrame::iterations, "solver iterations");
  property("sigma", &TrackedFrame::sigma,
           "spread of the residuals over the assumed noise");
  property("track_ms", &TrackedFrame::track_ms, "total time of tracking, ms");
  property("match_ms", &TrackedFrame::match_ms, "part of track_ms: matching");
  property("solve_ms", &TrackedFrame::solve_ms,
           "part of track_ms: motion estimation");
  property("reference_ms", &TrackedFrame::reference_ms,
           "part of track_ms: features of a new reference");
  property("relocalise_ms", &TrackedFrame::relocalise_ms,
           "part of track_ms: relocalisation when lost");
  frame
      .def("__repr__",
           [](const TrackedFrame& self) {
             return "TrackedFrame(" + FrameInWords(self) + ")";
           })
      .def(Pickled<TrackedFrame>());
}

void BindLivePage(py::module_* module) {
  py::class_<LivePage> page(*module, "LivePage",
                            "A page that shows a tracker live in a browser on "
                            "this machine; in a notebook, a link.");
  const py::call_guard<ReleasedGil> no_gil;
  page.def_readonly("address", &LivePage::address,
                    "such as 'http://127.0.0.1:40123/'");
  page.def_property_readonly(
      "is_stopped",
      py::cpp_function(
          [](const LivePage& self) { return self.tracker->IsStopped(); },
          no_gil),
      "whether the button Stop was pressed: track no more frames");
  page.def(
      "close", [](const LivePage& self) { self.tracker->CloseView(); }, no_gil,
      "Ends the page; open browsers keep what they show.");
  page.def("__repr__", [](const LivePage& self) {
    return "LivePage('" + self.address + "')";
  });
  page.def("_repr_html_", [](const LivePage& self) {
    return "<a href=\"" + self.address +
           "\" target=\"_blank\">live page: " + self.address + "</a>";
  });
}

}  // namespace

void BindOdometry(py::module_* module) {
  BindRelativePose(module);
  BindTrackedFrame(module);
  BindLivePage(module);
  BindTracker<SharedOdometry, OdometrySettings>(
      module, "Odometry", R"(
Tracks a camera frame by frame against a reference frame. Calls of one object
from several threads wait for each other; objects do not share anything.

)",
      R"(
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

Both images are copied, so the arrays may be reused afterwards. A lost frame is
reported by its status. Images of a wrong shape or type raise InputError and are
not counted as frames.)",
      "(timestamps (N,), world_from_cam (N, 4, 4)) of frames not lost");
}

}  // namespace rgbd_pose
