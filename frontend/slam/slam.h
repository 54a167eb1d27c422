#pragma once

#include <deque>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/inertial/gravity_estimate.h"
#include "core/inertial/mean_force.h"
#include "core/util/worker.h"
#include "frontend/settings/settings.h"
#include "frontend/slam/mapper.h"
#include "frontend/tracking/odometry.h"

namespace rgbd_pose {

// The settings of a Slam in addition to those of its odometry.
struct SlamSettings {
  MappingOptions mapping;  // which keyframes are connected

  // Results of the mapping thread are applied this number of frames after their
  // keyframe, waited for if late: they do not depend on the machine's speed.
  int update_delay = 10;

  // Whether Finish turns the world upright, if gravity is known and no map was
  // loaded: see Slam::upright_from_tracked.
  bool upright = false;
};

// The settings by name, bound to `settings`, which must outlive the table.
std::vector<Setting> SettingTable(SlamSettings* settings);

// The result for one frame.
struct SlamFrame {
  TrackedFrame tracked;  // in the world of the odometry

  Rigid3d odom_from_cam;  // without jumps from map corrections
  Rigid3d map_from_odom;  // the correction; changes at keyframes and loops

  int segment = 0;  // of the map; unconnected ones have separate worlds

  // Map updates that were applied at this frame, see MapUpdate.
  int pairs = 0;
  int loops = 0;
  int joined = 0;
  std::string error;
  double map_ms = 0.0;
  double wait_ms = 0.0;  // waiting time for late updates

  // The currently known pose in the map.
  Rigid3d map_from_cam() const { return map_from_odom * odom_from_cam; }
};

// A result of the mapping thread and the frame at which it is due. Not nested
// in Slam, because clang 14 fails on that.
template <typename Result>
struct PendingResult {
  int frame = 0;               // frame at which the result is applied
  std::future<Result> result;  // waited for at that frame
};

// Tracks a camera (Odometry) and builds a map of its keyframes in a background
// thread. When the camera returns to a known place, the path is corrected. The
// same frames give the same bytes. An object must be used from one thread only.
class Slam {
 public:
  // Throws InputError for invalid settings.
  Slam(const OdometrySettings& odometry, const SlamSettings& settings,
       const RgbdCamera& camera);

  // Starts with maps of the same camera; call it before the first frame. The
  // first frames form a segment of their own, which is joined to the map when
  // they see a mapped place. Separate maps are joined when the camera sees
  // both. Ids and segments are moved up where they are negative or in use.
  // `is_held`: tracks within the map without changing it. Throws InputError for
  // a map of another camera or an invalid map.
  void Load(KeyframeMap map, bool is_held);

  // Says what is known of an inertial sensor beside the camera; call it before
  // the first frame.
  void UseImu(const ImuSensor& sensor) {
    meter_.emplace(sensor);
    odometry_.UseImu(sensor);
  }

  // Adds samples of that sensor (RgbdFrame::imu) in the order of their stamps.
  // Without UseImu they have no effect.
  void AddImu(const std::vector<ImuSample>& samples) {
    if (!meter_.has_value()) return;
    meter_->Add(samples);
    odometry_.AddImu(samples);
  }

  // See Odometry::Track.
  SlamFrame Track(const Frame& frame,
                  const Rigid3d* cur_from_prev_guess = nullptr,
                  const MotionMatrix* guess_covariance = nullptr);

  // The same for a prepared frame.
  SlamFrame Track(const PreparedFrame& frame,
                  const Rigid3d* cur_from_prev_guess = nullptr,
                  const MotionMatrix* guess_covariance = nullptr);
  void Prepare(const PreparedFrame& frame) const { odometry_.Prepare(frame); }

  // Waits for the mapping thread, optimises all keyframes once more, with what
  // is known of gravity, and turns the world upright (SlamSettings::upright).
  // Afterwards only the following functions may be called.
  void Finish();

  // After Finish: the map, see Mapper::Map.
  KeyframeMap Map(bool as_solved = false) const {
    return mapper_.Map(as_solved);
  }

  // After Finish: covariances of the keyframe poses in map order, [omega (rad),
  // C (m)] as in PoseGraph (Mapper::Covariances); empty if they cannot be
  // computed.
  std::vector<MotionMatrix> Covariances() const {
    return mapper_.Covariances();
  }

  // After Finish: the graph of keyframe pairs.
  const KeyframeGraph& graph() const { return mapper_.graph(); }

  // After Finish: why the final optimisation failed, or empty.
  const std::string& error() const { return error_; }

  // The current poses (map_from_cam) of all frames that were not lost.
  Trajectory Path() const;

  // The segments of the same frames, as currently known.
  std::vector<int> PathSegments() const;

  // After Finish: how it has turned the poses of the map: by the smallest angle
  // that lets the z axis of the world point up, about the first camera. The
  // identity if it was not to, without gravity and with a loaded map, whose
  // world stays. It applies to SlamFrame::map_from_odom of frames before.
  const Rigid3d& upright_from_tracked() const { return upright_from_tracked_; }

  // After Finish: gravity in the world of the segment with the most frames;
  // nothing without UseImu.
  const std::optional<GravityEstimate>& gravity() const { return gravity_; }

  // The current poses (map_from_cam) of keyframes by map id, and the links
  // between keyframes that were applied so far.
  const std::map<int, Rigid3d>& keyframe_poses() const {
    return map_from_keyframe_;
  }
  const std::vector<MapEdge>& links() const { return links_; }
  // Converts an odometry frame number (TrackedFrame::reference) to a map id.
  int MapId(int frame) const { return frame + first_id_; }

  const Odometry& odometry() const { return odometry_; }

 private:
  // A frame relative to the keyframe that it was tracked against.
  struct PathFrame {
    double timestamp = 0.0;
    int keyframe = 0;
    Rigid3d keyframe_from_cam;
  };

  void Follow(const TrackedFrame& tracked);
  void BecomeReference(const TrackedFrame& tracked);
  // Passes a keyframe of the odometry to the mapper.
  void AddKeyframe(const TrackedFrame& tracked);

  // In slam_gravity.cc. The current poses (map_from_cam) of the frames of each
  // segment; gives the mapper what is measured of gravity in its keyframes.
  std::map<int, Trajectory> PathsBySegment() const;
  void MeasureUps();
  void FindGravity();

  void ApplyPendingUpdates(int frame, SlamFrame* result);
  void Apply(MapUpdate update, SlamFrame* result);
  void Adopt(Keyframe keyframe);

  const SlamSettings settings_;
  Odometry odometry_;
  Mapper mapper_;  // used by worker_ only, once it has started

  TrackedFrame previous_;  // the last frame
  // Whether previous_ is a keyframe that is not yet passed to the mapper: the
  // next frame shows how the camera moved during its exposure.
  bool is_previous_late_ = false;

  // State after the last applied update.
  std::map<int, Rigid3d> map_from_keyframe_;
  std::map<int, int> segments_;
  std::vector<MapEdge> links_;

  // State of the last frame.
  std::optional<int> reference_;  // map id of its reference
  Rigid3d odom_from_reference_;
  Rigid3d odom_from_cam_;
  Rigid3d map_from_odom_;

  int first_id_ = 0;       // offset of new keyframe ids
  int first_segment_ = 0;  // offset of new segments

  std::string error_;                       // of the last update
  std::optional<ForceMeter> meter_;         // of the inertial sensor
  std::optional<GravityEstimate> gravity_;  // since Finish
  Rigid3d upright_from_tracked_;            // likewise
  std::vector<PathFrame> path_;
  // Keyframes that no update includes yet, oldest first, and their references.
  struct Pending {
    int id = 0;
    std::optional<int> ref;
    Rigid3d ref_from_cam;
  };
  std::deque<Pending> pending_;
  std::deque<PendingResult<MapUpdate>> updates_;
  std::optional<PendingResult<std::optional<Keyframe>>> search_;
  Worker worker_;  // last, as it uses the members above
};

}  // namespace rgbd_pose
