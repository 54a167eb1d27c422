#include "apps/results/slam_output.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/results/frame_tables.h"
#include "core/util/format.h"
#include "core/util/quantile.h"

namespace rgbd_pose {
namespace {

// g2o's error of an edge is [t, vec q] of measured^-1 * true, ref_from_cur. Our
// error in these terms is [R c, -omega / 2] with R of cur_from_ref.
MotionMatrix G2oInformation(const RelativePose& edge) {
  MotionMatrix J = MotionMatrix::Zero();
  J.topRightCorner<3, 3>() = edge.cur_from_ref.rotation.toRotationMatrix();
  J.bottomLeftCorner<3, 3>() = -0.5 * Eigen::Matrix3d::Identity();
  return (J * edge.covariance * J.transpose()).inverse();
}

// The first frame with a known pose in a loaded map; -1 if there is none, null
// without a loaded map (whose segment numbers precede those of the frames).
nlohmann::json LocalisedFrom(const std::vector<SlamFrame>& frames) {
  if (frames.empty() || frames[0].segment == 0) return nullptr;
  const auto found =
      std::find_if(frames.begin(), frames.end(), [&](const SlamFrame& frame) {
        return frame.segment < frames[0].segment;
      });
  return found == frames.end() ? -1 : static_cast<int>(found - frames.begin());
}

}  // namespace

std::string FormatSlamCsv(const Slam& slam,
                          const std::vector<SlamFrame>& frames) {
  std::string text =
      "timestamp,status,segment,final_segment,odom_tx,odom_ty,odom_tz,odom_qx,"
      "odom_qy,odom_qz,odom_qw,map_tx,map_ty,map_tz,map_qx,map_qy,map_qz,"
      "map_qw,pairs,loops,joined,map_ms,wait_ms\n";
  const std::vector<int> segments = slam.PathSegments();  // none of lost frames
  auto segment = segments.begin();
  for (const SlamFrame& frame : frames) {
    const bool is_lost = frame.tracked.status == TrackingStatus::kLost;
    text += Format("%.6f,%s,%d,%d", frame.tracked.timestamp,
                   ToString(frame.tracked.status), frame.segment,
                   is_lost ? -1 : *segment++) +
            FormatPose(frame.odom_from_cam) + FormatPose(frame.map_from_odom) +
            Format(",%d,%d,%d,%.3f,%.3f\n", frame.pairs, frame.loops,
                   frame.joined, frame.map_ms, frame.wait_ms);
  }
  return text;
}

std::string FormatOnlineTrajectory(const Slam& slam,
                                   const std::vector<SlamFrame>& frames) {
  std::set<int> segments;
  for (int at = 0; at < slam.graph().size(); ++at) {
    segments.insert(slam.graph().segment(at));
  }
  Trajectory path;
  for (const SlamFrame& frame : frames) {
    if (frame.tracked.status != TrackingStatus::kLost &&
        segments.count(frame.segment) != 0) {
      path.push_back({frame.tracked.timestamp, frame.map_from_cam()});
    }
  }
  return FormatTrajectory(path);
}

std::string FormatKeyframesCsv(const KeyframeMap& map,
                               const std::vector<MotionMatrix>& covariances) {
  std::string text =
      std::string("keyframe,timestamp,segment,tx,ty,tz,qx,qy,qz,qw") +
      kCovarianceColumns + "\n";
  for (size_t k = 0; k < map.keyframes.size(); ++k) {
    const Keyframe& keyframe = map.keyframes[k];
    text += Format("%d,%.6f,%d", keyframe.id, keyframe.images.timestamp,
                   keyframe.segment) +
            FormatPose(keyframe.world_from_cam) +
            (covariances.empty() ? std::string(21, ',')
                                 : FormatTriangle(covariances[k])) +
            "\n";
  }
  return text;
}

std::string FormatG2o(const KeyframeMap& map) {
  std::string text;
  std::map<int, int> first_of_segment;
  for (const Keyframe& keyframe : map.keyframes) {
    text += Format("VERTEX_SE3:QUAT %d", keyframe.id) +
            FormatPose(keyframe.world_from_cam, ' ') + "\n";
    if (first_of_segment.emplace(keyframe.segment, keyframe.id).second) {
      text += Format("FIX %d\n", keyframe.id);
    }
  }
  for (const RelativePose& edge : map.edges) {
    text += Format("EDGE_SE3:QUAT %d %d", edge.ref, edge.cur) +
            FormatPose(edge.cur_from_ref.Inverse(), ' ') +
            FormatTriangle(G2oInformation(edge), ' ') + "\n";
  }
  return text;
}

nlohmann::json SlamToJson(const Slam& slam,
                          const std::vector<SlamFrame>& frames) {
  const KeyframeGraph& graph = slam.graph();
  int tracked = 0, pairs = 0, loops = 0, joined = 0, dropped = 0;
  std::vector<std::string> errors;
  double map_ms = 0.0;
  std::vector<double> waits, works;
  for (const SlamFrame& frame : frames) {
    joined += frame.joined;
    if (!frame.error.empty()) errors.push_back(frame.error);
    map_ms += frame.map_ms;
    waits.push_back(frame.wait_ms);
    if (frame.map_ms > 0.0) works.push_back(frame.map_ms);
  }
  if (!slam.error().empty()) errors.push_back(slam.error());
  nlohmann::json keyframes = nlohmann::json::array();
  for (int at = 0; at < graph.size(); ++at) {
    dropped += graph.IsRemoved(at);
    const Eigen::Vector3d& t = graph.pose(at).translation;
    keyframes.push_back(
        {t.x(), t.y(), t.z(), graph.segment(at), graph.IsRemoved(at)});
  }
  nlohmann::json edges = nlohmann::json::array();
  for (const MapEdge& pair : graph.pairs()) {
    tracked += pair.is_tracked;
    loops += pair.is_loop;
    pairs += !pair.is_tracked;
    const int kind = pair.is_tracked ? 0 : 1 + pair.is_loop;
    edges.push_back({pair.ref, pair.cur, kind});
  }
  return {{"keyframes", graph.size() - dropped},
          {"keyframes_dropped", dropped},
          {"tracked_pairs", tracked},
          {"pairs", pairs},
          {"loops", loops},
          {"segments_joined", joined},
          {"localised_from_frame", LocalisedFrom(frames)},
          {"proportional_error", graph.proportional_error()},
          {"unsolved", errors.size()},
          {"error", errors.empty() ? "" : errors.back()},
          {"map_ms_per_frame", frames.empty() ? 0.0 : map_ms / frames.size()},
          {"map_ms_per_keyframe", works.empty() ? 0.0 : Median(works)},
          {"wait_ms_p99", waits.empty() ? 0.0 : Quantile(waits, 0.99)},
          {"wait_ms_max", waits.empty() ? 0.0 : Quantile(waits, 1.0)},
          {"graph_keyframes", keyframes},
          {"graph_pairs", edges}};
}

std::string SlamWarning(const nlohmann::json& slam) {
  const int unsolved = slam.at("unsolved").get<int>();
  if (unsolved == 0) return "";
  return Format("solving for the map's poses failed %d time%s; last reason: %s",
                unsolved, unsolved == 1 ? "" : "s",
                slam.at("error").get<std::string>().c_str());
}

std::string FormatSlamSummary(const nlohmann::json& slam) {
  const auto number = [&](const char* key) {
    return slam.at(key).get<double>();
  };
  const auto whole = [&](const char* key) { return slam.at(key).get<int>(); };
  const nlohmann::json& from = slam.at("localised_from_frame");
  const std::string localised =
      from.is_null() ? ""
      : from < 0 ? "localised   never: no frame was found in the loaded map\n"
                 : Format("localised   in the loaded map from frame %d on\n",
                          from.get<int>());
  return localised +
         Format(
             "map         %d keyframes (%d more removed), %d pairs, %d "
             "loops, %d segments joined\n"
             "mapping     %.2f ms per frame, %.1f ms per keyframe median; "
             "tracking waited %.1f ms at most\n",
             whole("keyframes"), whole("keyframes_dropped"),
             whole("tracked_pairs") + whole("pairs"), whole("loops"),
             whole("segments_joined"), number("map_ms_per_frame"),
             number("map_ms_per_keyframe"), number("wait_ms_max"));
}

}  // namespace rgbd_pose
