#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/pickling.h"
#include "apps/python/released_gil.h"
#include "apps/python/tracker_bindings.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "frontend/settings/settings.h"
#include "frontend/slam/map_folder.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// A frame for Python: the result of the odometry and the pose in the map.
struct FrameInMap : TrackedFrame, SlamFrame {
  explicit FrameInMap(const SlamFrame& frame = {})
      : TrackedFrame(frame.tracked), SlamFrame(frame) {}
};

void EachField(PickledBytes* bytes, FrameInMap& f) {
  (*bytes)(static_cast<TrackedFrame&>(f), f.tracked, f.odom_from_cam,
           f.map_from_odom, f.SlamFrame::segment, f.pairs, f.loops, f.joined,
           f.error, f.map_ms, f.wait_ms);
}

// A keyframe of the map without its images.
struct KeyframePose {
  int id = 0;
  int segment = 0;
  double timestamp = 0.0;
  Rigid3d map_from_cam;
  std::optional<MotionMatrix> covariance;  // empty if not computable
};

void EachField(PickledBytes* bytes, KeyframePose& k) {
  (*bytes)(k.id, k.segment, k.timestamp, k.map_from_cam, k.covariance);
}

struct SharedSlamSettings {
  OdometrySettings odometry;
  SlamSettings slam;
};

std::vector<Setting> SettingTable(SharedSlamSettings* settings) {
  std::vector<Setting> table = SettingTable(&settings->odometry);
  const std::vector<Setting> more = SettingTable(&settings->slam);
  table.insert(table.end(), more.begin(), more.end());
  return table;
}

class SharedSlam : public SharedRun {
 public:
  SharedSlam(const SharedSlamSettings& settings, const RgbdCamera& camera)
      : SharedRun(camera,
                  SequenceRun(settings.odometry, settings.slam, camera)) {}

  // Throws InputError after the first frame, and if there is no map of this
  // camera.
  void Load(const std::string& folder, bool localise_only) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!run_.frames().empty() || is_finished_) {
      throw InputError("load_map: maps must be loaded before the first frame");
    }
    run_.slam()->Load(LoadMap(folder), localise_only);
    is_held_ = is_held_ || localise_only;
  }

  // See SharedRun::Add. Throws InputError after Finish.
  FrameInMap Track(Frame frame, std::optional<double> timestamp,
                   const Rigid3d* guess) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (is_finished_) {
      throw InputError(
          "track: finish() was called; save the map and load it in another "
          "Slam to continue");
    }
    Add(std::move(frame), timestamp, guess);
    SlamFrame result = run_.slam_frames().back();
    result.tracked.edges = run_.frames().back().edges;
    return FrameInMap(result);
  }

  // Waits for the mapping thread, once, and ends the live page.
  void Finish() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!is_finished_) run_.slam()->Finish();
    is_finished_ = true;
    if (view_ != nullptr) view_->Finish("");
  }

  // The following functions throw InputError before Finish.
  std::vector<KeyframePose> Keyframes() {
    const auto lock = LockFinished("keyframes");
    const std::vector<MotionMatrix> covariances = run_.slam()->Covariances();
    std::vector<KeyframePose> poses;
    for (const Keyframe& keyframe : run_.slam()->Map().keyframes) {
      std::optional<MotionMatrix> covariance;
      if (!covariances.empty()) covariance = covariances[poses.size()];
      poses.push_back({keyframe.id, keyframe.segment, keyframe.images.timestamp,
                       keyframe.world_from_cam, covariance});
    }
    return poses;
  }

  std::vector<RelativePose> Edges() {
    const auto lock = LockFinished("edges");
    const std::vector<MapEdge> edges = run_.slam()->Map().edges;
    return std::vector<RelativePose>(edges.begin(), edges.end());
  }

  void Save(const std::string& folder) {
    const auto lock = LockFinished("save_map");
    if (is_held_) {
      throw InputError(
          "save_map: localise_only does not change the map, so there is "
          "nothing to save");
    }
    SaveMap(folder, run_.slam()->Map());
  }

 private:
  std::unique_lock<std::mutex> LockFinished(const std::string& what) {
    std::unique_lock<std::mutex> lock(mutex_);
    if (is_finished_) return lock;
    throw InputError(what + ": finish() must be called first");
  }

  bool is_finished_ = false;
  bool is_held_ = false;
};

void BindSlamFrame(py::module_* module) {
  py::class_<FrameInMap, TrackedFrame> frame(
      *module, "SlamFrame",
      "The result of one frame: its tracking result and its pose in the map.");
  const auto property = PropertiesOf(&frame);
  property("odom_from_cam", &SlamFrame::odom_from_cam,
           "(4, 4), m: drifts, but never jumps when the map is corrected");
  property("map_from_odom", &SlamFrame::map_from_odom,
           "(4, 4), m: the correction; changes at keyframes and loops");
  property(
      "map_from_cam",
      [](const FrameInMap& self) { return ToPython(self.map_from_cam()); },
      "(4, 4), m: map_from_odom @ odom_from_cam, the current pose in the map");
  property("segment", &SlamFrame::segment,
           "of the map: relative poses are known only within a segment");
  property("pairs", &SlamFrame::pairs,
           "keyframe pairs added to the map since the previous frame");
  property("loops", &SlamFrame::loops,
           "number of loop closures among these pairs");
  property("joined", &SlamFrame::joined,
           "number of segments joined to another one");
  property("error", &SlamFrame::error,
           "why poses were not corrected; empty: they were");
  property("map_ms", &SlamFrame::map_ms,
           "mapping time in the background thread, ms");
  property("wait_ms", &SlamFrame::wait_ms,
           "time that tracking waited for the map, ms");
  frame
      .def("__repr__",
           [](const FrameInMap& self) {
             return Format("SlamFrame(%s, pairs=%d, loops=%d)",
                           FrameInWords(self).c_str(), self.pairs, self.loops);
           })
      .def(Pickled<FrameInMap>());
}

void BindKeyframe(py::module_* module) {
  py::class_<KeyframePose> keyframe(*module, "Keyframe",
                                    "A keyframe of the map.");
  const auto property = PropertiesOf(&keyframe);
  property("id", &KeyframePose::id,
           "id in the map; without a loaded map the index of its frame");
  property("segment", &KeyframePose::segment,
           "poses of one segment share one map");
  property("timestamp", &KeyframePose::timestamp, "s");
  property("map_from_cam", &KeyframePose::map_from_cam, "(4, 4), m");
  property(
      "covariance",
      [](const KeyframePose& self) -> py::object {
        if (!self.covariance.has_value()) return py::none();
        return ArrayFromMatrix(*self.covariance);
      },
      "(6, 6), of a small rotation about the axes of the camera (rad) and of "
      "its\ncentre in the map (m); zero for the first of a segment, None if it "
      "cannot\nbe computed");
  keyframe
      .def("__repr__",
           [](const KeyframePose& self) {
             const Eigen::Vector3d& at = self.map_from_cam.translation;
             return Format(
                 "Keyframe(%d at %.6f s: segment %d, centre %.3f %.3f %.3f m)",
                 self.id, self.timestamp, self.segment, at.x(), at.y(), at.z());
           })
      .def(Pickled<KeyframePose>());
}

}  // namespace

void BindSlam(py::module_* module) {
  BindSlamFrame(module);
  BindKeyframe(module);
  auto slam = BindTracker<SharedSlam, SharedSlamSettings>(
      module, "Slam", R"(
Tracks a camera as Odometry does and builds a map of its keyframes in a thread in
the background. When the camera returns to a known place, the path is corrected.
The same frames give identical results. Calls of one object from several
threads wait for each other; objects do not share anything.

)",
      "Tracks the next frame; arguments are those of Odometry.track. The GIL "
      "is\nreleased. Raises InputError after finish().",
      "(timestamps (N,), map_from_cam (N, 4, 4)) of frames not lost, with "
      "all\ncorrections so far");
  const py::call_guard<ReleasedGil> no_gil;
  slam.def("finish", &SharedSlam::Finish, no_gil,
           "Waits for the background thread, corrects all poses once more and "
           "ends the "
           "live page. No frame can\nbe tracked afterwards.");
  slam.def("keyframes", &SharedSlam::Keyframes, no_gil,
           "After finish(): list of Keyframe, in the order of the map.");
  slam.def("edges", &SharedSlam::Edges, no_gil,
           "After finish(): list of RelativePose, the measured motions between "
           "keyframes; ref\nand cur are ids of keyframes.");
  slam.def(
      "save_map",
      [](SharedSlam* self, const py::object& folder) {
        const std::string path = PathFrom(folder);
        const ReleasedGil released;
        self->Save(path);
      },
      "After finish(): saves the map to a folder and replaces an existing map "
      "there.\nRaises InputError if that fails.",
      py::arg("folder"));
  slam.def(
      "load_map",
      [](SharedSlam* self, const py::object& folder, bool localise_only) {
        const std::string path = PathFrom(folder);
        const ReleasedGil released;
        self->Load(path, localise_only);
      },
      "Before the first frame: loads a saved map; several maps are joined "
      "where they\noverlap. localise_only: the map is not changed. Raises "
      "InputError for a folder\nwithout a map and for a map of another camera.",
      py::arg("folder"), py::arg("localise_only") = false);
}

}  // namespace rgbd_pose
