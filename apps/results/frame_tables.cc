#include "apps/results/frame_tables.h"

#include "core/util/format.h"

namespace rgbd_pose {
namespace {

std::string FormatPose(const Rigid3d& pose) {
  std::string text;
  for (const double value : pose.translation) text += Format(",%.9g", value);
  for (const double value : pose.rotation.coeffs()) {
    text += Format(",%.9g", value);
  }
  return text;
}

}  // namespace

std::string FormatFramesCsv(const std::vector<TrackedFrame>& frames) {
  std::string text =
      "timestamp,status,reason,segment,reference,is_reference,relocalised,"
      "predicted,carried_by,matches,inliers,iterations,sigma,"
      "tx,ty,tz,qx,qy,qz,qw,"
      "decode_ms,track_ms,match_ms,solve_ms,reference_ms,relocalise_ms\n";
  for (const TrackedFrame& frame : frames) {
    // Reasons are our own words and hold no quotes.
    text += Format("%.6f,%s,\"%s\",%d,%d,%d,%d,%d,%s,%d,%d,%d,%.4f",
                   frame.timestamp, ToString(frame.status),
                   frame.reason.c_str(), frame.segment, frame.reference,
                   frame.is_reference, frame.relocalised, frame.is_predicted,
                   std::string(frame.carried_by).c_str(), frame.matches,
                   frame.inliers, frame.iterations, frame.sigma);
    text += FormatPose(frame.world_from_cam);
    for (const double ms :
         {frame.decode_ms, frame.track_ms, frame.match_ms, frame.solve_ms,
          frame.reference_ms, frame.relocalise_ms}) {
      text += Format(",%.3f", ms);
    }
    text += "\n";
  }
  return text;
}

std::string FormatEdgesCsv(const std::vector<TrackedFrame>& frames) {
  constexpr const char* kParts[] = {"wx", "wy", "wz", "cx", "cy", "cz"};
  std::string text = "ref,cur,tx,ty,tz,qx,qy,qz,qw";
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      text += Format(",cov_%s_%s", kParts[i], kParts[j]);
    }
  }
  text += "\n";
  for (const TrackedFrame& frame : frames) {
    for (const Edge& edge : frame.edges) {
      text += Format("%d,%d", edge.ref, edge.cur);
      text += FormatPose(edge.cur_from_ref);
      for (int i = 0; i < 6; ++i) {
        for (int j = i; j < 6; ++j) {
          text += Format(",%.9g", edge.covariance(i, j));
        }
      }
      text += "\n";
    }
  }
  return text;
}

}  // namespace rgbd_pose
