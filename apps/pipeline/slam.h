#pragma once

#include <deque>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/settings.h"
#include "core/evaluation/trajectory.h"
#include "core/util/worker.h"
#include "frontend/mapping/mapper.h"
#include "frontend/tracking/odometry.h"

namespace rgbd_pose {

// What a Slam is made of besides its odometry.
struct SlamSettings {
  MappingOptions mapping;  // which keyframes are joined to which

  // What is found out behind the tracking is taken up so many frames after the
  // keyframe that it follows from, and waited for if it is late: so results do
  // not depend on the speed of a machine.
  int update_delay = 10;
};

// Their rows.
std::vector<Setting> SettingTable(SlamSettings* settings);

// Maps, as users say them; empty: none.
struct MapSettings {
  std::string save_map;        // folder
  std::string load_map;        // folders, separated by commas
  bool localise_only = false;  // the loaded map stays as it is
};

// Their rows.
std::vector<Setting> SettingTable(MapSettings* settings);

// What became of one frame. Its pose in the map, as known now, is map_from_odom
// * odom_from_cam.
struct SlamFrame {
  TrackedFrame tracked;  // in the odometry's own world

  // Moves on smoothly, whatever is corrected behind it.
  Rigid3d odom_from_cam;
  // The correction: changes at keyframes and loops.
  Rigid3d map_from_odom;

  // Of the map. Segments that nothing joins have worlds of their own.
  int segment = 0;

  // What was taken up here of the work behind, as MapUpdate has it.
  int pairs = 0;
  int loops = 0;
  int joined = 0;
  std::string error;
  double map_ms = 0.0;
  double wait_ms = 0.0;  // that it was late

  // As known now.
  Rigid3d map_from_cam() const { return map_from_odom * odom_from_cam; }
};

// Work behind, and the frame that it is due at. Not within Slam: clang 14 fails
// there.
template <typename Result>
struct PendingResult {
  int frame = 0;               // the one that takes it over
  std::future<Result> result;  // waited for there
};

// Tracks a camera (Odometry) and builds a map of its keyframes behind it, in a
// thread of its own: where the view returns, the path is corrected. The same
// frames give the same bytes. One object serves one thread.
class Slam {
 public:
  // Throws InputError for invalid settings.
  Slam(const OdometrySettings& odometry, const SlamSettings& settings,
       const Camera& camera);

  // Begins with maps of the same camera; to be called before the first frame.
  // The first frames have a segment of their own, which is joined to the map
  // where they meet it, and maps are joined where a camera sees both.
  // `is_held`: tracks within the map without changing it. Throws InputError for
  // a map of another camera or one that is not sound.
  void Load(KeyframeMap map, bool is_held);

  // As Odometry::Track.
  SlamFrame Track(const Frame& frame,
                  const Rigid3d* cur_from_prev_guess = nullptr,
                  const MotionMatrix* guess_covariance = nullptr);

  // The same with what has been made of the frame already.
  SlamFrame Track(const PreparedFrame& frame,
                  const Rigid3d* cur_from_prev_guess = nullptr,
                  const MotionMatrix* guess_covariance = nullptr);
  void Prepare(const PreparedFrame& frame) const { odometry_.Prepare(frame); }

  // Waits for the work behind and solves for all keyframes once more. The last
  // call but for the following.
  void Finish();

  // After Finish: the map, see Mapper::Map.
  KeyframeMap Map(bool as_solved = false) const {
    return mapper_.Map(as_solved);
  }

  // After Finish: covariances of its keyframes' poses in their order, [omega
  // (rad), C (m)] as PoseGraph has them; empty if they cannot be computed.
  std::vector<MotionMatrix> Covariances() const {
    return mapper_.Covariances();
  }

  // After Finish: the pairs it is held together by.
  const KeyframeGraph& graph() const { return mapper_.graph(); }

  // After Finish: why poses of the map were not solved for at last, or empty.
  const std::string& error() const { return error_; }

  // The poses of all frames that were not lost, map_from_cam, as known now.
  Trajectory Path() const;

  // Keyframes by their names in the map: where they are (map_from_cam) and what
  // joins them, as taken up so far.
  const std::map<int, Rigid3d>& keyframe_poses() const {
    return map_from_keyframe_;
  }
  const std::vector<MapLink>& links() const { return links_; }
  // The name in the map of a keyframe that the odometry knows by
  // TrackedFrame::reference.
  int MapId(int frame) const { return frame + first_id_; }

  // What the last frame was tracked by.
  const Odometry& odometry() const { return odometry_; }

 private:
  // A frame by the keyframe that it was tracked against.
  struct PathFrame {
    double timestamp = 0.0;
    int keyframe = 0;
    Rigid3d keyframe_from_cam;
  };

  // The odometry counts its own frames from 0.
  int OdometryId(int keyframe) const { return keyframe - first_id_; }

  void Follow(const TrackedFrame& tracked);
  void BecomeReference(const TrackedFrame& tracked);
  // Hands a keyframe of the odometry to the mapper.
  void AddKeyframe(const TrackedFrame& tracked);
  void SearchMap(const PreparedFrame& frame, int index);
  void ApplyPendingUpdates(int frame, SlamFrame* result);
  void Apply(MapUpdate update, SlamFrame* result);
  void MoveNewer();
  void Adopt(Keyframe keyframe);

  const SlamSettings settings_;
  Odometry odometry_;
  Mapper mapper_;  // of worker_, once it has begun

  TrackedFrame previous_;  // the last frame
  // It is a keyframe that waits for the next one, which shows how the camera
  // moved in it.
  bool is_previous_late_ = false;

  // As last taken up.
  std::map<int, Rigid3d> map_from_keyframe_;
  std::map<int, int> segments_;
  std::vector<MapLink> links_;

  // Where the last frame is.
  std::optional<int> reference_;  // by its name in the map
  Rigid3d odom_from_reference_;
  Rigid3d odom_from_cam_;
  Rigid3d map_from_odom_;
  Rigid3d world_from_cam_;  // of the odometry

  int first_id_ = 0;       // of new keyframes
  int first_segment_ = 0;  // of new ones

  std::string error_;  // at last
  std::vector<PathFrame> path_;
  // Keyframes that no update has taken in yet, the oldest first, by the one
  // that they were tracked against.
  struct Pending {
    int id = 0;
    std::optional<int> ref;
    Rigid3d ref_from_cam;
  };
  std::deque<Pending> pending_;
  std::deque<PendingResult<MapUpdate>> updates_;
  std::optional<PendingResult<std::optional<Keyframe>>> search_;
  Worker worker_;  // the last: it works with what is above
};

}  // namespace rgbd_pose
