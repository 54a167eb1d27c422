#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <vector>

#include "apps/pipeline/settings.h"
#include "apps/pipeline/slam.h"
#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/frame_images.h"
#include "apps/python/pickling.h"
#include "apps/python/released_gil.h"
#include "apps/python/setting_arguments.h"
#include "apps/python/shared_slam.h"
#include "core/util/text_file.h"

namespace py = pybind11;

namespace rgbd_pose {
static void EachField(PickledBytes* bytes, FrameInMap& f) {
  SlamFrame& slam = f.slam;
  (*bytes)(static_cast<TrackedFrame&>(f), slam.tracked, slam.odom_from_cam,
           slam.map_from_odom, slam.segment, slam.pairs, slam.loops,
           slam.joined, slam.error, slam.map_ms, slam.wait_ms);
}

static void EachField(PickledBytes* bytes, KeyframePose& k) {
  (*bytes)(k.id, k.segment, k.timestamp, k.map_from_cam, k.covariance);
}

namespace {

struct Settings {
  OdometrySettings odometry;
  SlamSettings slam;

  std::vector<Setting> Table() {
    std::vector<Setting> table = SettingTable(&odometry);
    for (const Setting& setting : SettingTable(&slam)) table.push_back(setting);
    return table;
  }
};

std::unique_ptr<SharedSlam> MakeSharedSlam(const RgbdCamera& camera,
                                           const std::string& frontend,
                                           const py::kwargs& keywords) {
  Settings settings;
  settings.odometry.frontend = frontend;
  SetFromKeywords("Slam", keywords, settings.Table());
  return std::make_unique<SharedSlam>(settings.odometry, settings.slam, camera);
}

// A getter for an additional member of SlamFrame.
template <typename T>
auto InMap(T SlamFrame::*member) {
  return
      [member](const FrameInMap& self) { return ToPython(self.slam.*member); };
}

void BindFrames(py::module_* module) {
  py::class_<FrameInMap, TrackedFrame>(
      *module, "SlamFrame",
      "The result of one frame: its tracking result and its pose in the map.")
      .def_property_readonly(
          "odom_from_cam", InMap(&SlamFrame::odom_from_cam),
          "(4, 4), m: drifts, but never jumps when the map is corrected")
      .def_property_readonly(
          "map_from_odom", InMap(&SlamFrame::map_from_odom),
          "(4, 4), m: the correction; changes at keyframes and loops")
      .def_property_readonly(
          "map_from_cam",
          [](const FrameInMap& self) {
            return ToPython(self.slam.map_from_cam());
          },
          "(4, 4), m: map_from_odom @ odom_from_cam, the current pose in the "
          "map")
      .def_property_readonly(
          "segment", InMap(&SlamFrame::segment),
          "of the map: relative poses are known only within a segment")
      .def_property_readonly(
          "pairs", InMap(&SlamFrame::pairs),
          "keyframe pairs added to the map since the previous frame")
      .def_property_readonly("loops", InMap(&SlamFrame::loops),
                             "number of loop closures among these pairs")
      .def_property_readonly("joined", InMap(&SlamFrame::joined),
                             "number of segments joined to another one")
      .def_property_readonly("error", InMap(&SlamFrame::error),
                             "why poses were not corrected; empty: they were")
      .def_property_readonly("map_ms", InMap(&SlamFrame::map_ms),
                             "mapping time in the background thread, ms")
      .def_property_readonly("wait_ms", InMap(&SlamFrame::wait_ms),
                             "time that tracking waited for the map, ms")
      .def(Pickled<FrameInMap>());
  py::class_<KeyframePose>(*module, "Keyframe", "A keyframe of the map.")
      .def_readonly("id", &KeyframePose::id,
                    "id in the map; without a loaded map the index of its "
                    "frame")
      .def_readonly("segment", &KeyframePose::segment,
                    "poses of one segment share one map")
      .def_readonly("timestamp", &KeyframePose::timestamp, "s")
      .def_property_readonly("map_from_cam", Get(&KeyframePose::map_from_cam),
                             "(4, 4), m")
      .def_property_readonly(
          "covariance",
          [](const KeyframePose& self) -> py::object {
            if (!self.covariance.has_value()) return py::none();
            return ArrayFromMatrix(*self.covariance);
          },
          "(6, 6), of a small rotation about the axes of the camera (rad) and "
          "of its\ncentre in the map (m); zero for the first of a segment, "
          "None if it cannot\nbe computed")
      .def(Pickled<KeyframePose>());
}

void BindSlamClass(py::module_* module) {
  Settings settings;
  const std::string doc = R"(
Tracks a camera as Odometry does and builds a map of its keyframes in a
background thread; loop closures correct the path. The same frames give the same
result, to the last bit. Calls of one object from several threads wait for each
other; objects do not share anything.

)" + HelpOf(settings.Table());
  py::class_<SharedSlam> slam(*module, "Slam", doc.c_str());
  DefineInit(&slam, &MakeSharedSlam, "Slam", settings.odometry.frontend,
             settings.Table());
  BindTracking(&slam,
               "Tracks the next frame; arguments are those of Odometry.track. "
               "The GIL is\nreleased. Raises InputError after finish().",
               "(timestamps (N,), map_from_cam (N, 4, 4)) of frames not lost, "
               "with all\ncorrections so far");
  const py::call_guard<ReleasedGil> no_gil;
  slam.def("finish", &SharedSlam::Finish, no_gil,
           "Waits for the background thread and corrects all poses once more. "
           "No frame can\nbe tracked afterwards.")
      .def("keyframes", &SharedSlam::Keyframes, no_gil,
           "After finish(): list of Keyframe, in the order of the map.")
      .def("edges", &SharedSlam::Edges, no_gil,
           "After finish(): list of RelativePose, the measured motions between "
           "keyframes; ref\nand cur are ids of keyframes.")
      .def(
          "save_map",
          [](SharedSlam* self, const py::object& folder) {
            const std::string path = PathFrom(folder);
            const ReleasedGil released;
            self->SaveMap(path);
          },
          "After finish(): saves the map to a folder and replaces an existing "
          "map there.\nRaises InputError if that fails.",
          py::arg("folder"))
      .def(
          "load_map",
          [](SharedSlam* self, const py::object& folder, bool localise_only) {
            const std::string path = PathFrom(folder);
            const ReleasedGil released;
            self->LoadMap(path, localise_only);
          },
          "Before the first frame: loads a saved map; several maps are joined "
          "where they\noverlap. localise_only: the map is not changed. Raises "
          "InputError for a folder\nwithout a map and for a map of another "
          "camera.",
          py::arg("folder"), py::arg("localise_only") = false);
}

}  // namespace

void BindSlam(py::module_* module) {
  BindFrames(module);
  BindSlamClass(module);
}

}  // namespace rgbd_pose
