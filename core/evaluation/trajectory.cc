#include "core/evaluation/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

constexpr std::array<std::string_view, 8> kColumns = {
    "timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"};
constexpr double kMaxQuaternionError = 0.01;  // deviation of its length from 1
constexpr double kMaxCoordinate = 1e9;        // m; squares stay finite

StampedPose ParsePose(const TextLine& line, const std::string& path) {
  if (line.words.size() != kColumns.size()) {
    throw InputError(path, line.number,
                     std::to_string(line.words.size()) +
                         " columns; a pose needs 8: timestamp tx ty tz qx qy "
                         "qz qw");
  }
  std::array<double, kColumns.size()> value{};
  value[0] = ParseTimestamp(line.words[0], path, line.number);
  for (size_t i = 1; i < kColumns.size(); ++i) {
    value[i] = ParseNumber(line.words[i], path, line.number, kColumns[i]);
  }
  const Eigen::Quaterniond rotation(value[7], value[4], value[5], value[6]);
  if (!(std::abs(rotation.norm() - 1.0) <= kMaxQuaternionError)) {
    throw InputError(path, line.number,
                     "the quaternion (columns 5 to 8, qx qy qz qw) is not of "
                     "unit length; check the order of the columns");
  }
  const Rigid3d pose(rotation, {value[1], value[2], value[3]});
  if (pose.translation.lpNorm<Eigen::Infinity>() > kMaxCoordinate) {
    throw InputError(path, line.number,
                     "the position (columns 2 to 4) is more than 1e9 m away; "
                     "check the order of the columns");
  }
  return {value[0], pose};
}

}  // namespace

std::optional<Rigid3d> InterpolatedPose(const Trajectory& trajectory,
                                        double time, double max_gap) {
  const auto after = std::lower_bound(
      trajectory.begin(), trajectory.end(), time,
      [](const StampedPose& pose, double at) { return pose.timestamp < at; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->timestamp == time) return after->world_from_cam;
  if (after == trajectory.begin()) return std::nullopt;
  const StampedPose& before = *(after - 1);
  const double gap = after->timestamp - before.timestamp;
  if (gap >= max_gap) return std::nullopt;
  const double share = (time - before.timestamp) / gap;
  const Rigid3d& a = before.world_from_cam;
  const Rigid3d& b = after->world_from_cam;
  return Rigid3d(a.rotation.slerp(share, b.rotation),
                 a.translation + share * (b.translation - a.translation));
}

std::optional<Rigid3d> MotionAlong(const Trajectory& trajectory,
                                   double prev_time, double cur_time) {
  // In a longer gap (s) a hand-held camera may have gone anywhere.
  constexpr double kMaxGap = 0.21;
  // Times beyond an end by at most this (s) are rounded stamps.
  constexpr double kMaxBeyond = 0.02;
  if (trajectory.empty()) return std::nullopt;
  const auto pose_at = [&](double time) -> std::optional<Rigid3d> {
    const double inside = std::clamp(time, trajectory.front().timestamp,
                                     trajectory.back().timestamp);
    if (!(std::abs(inside - time) <= kMaxBeyond)) return std::nullopt;
    return InterpolatedPose(trajectory, inside, kMaxGap);
  };
  const std::optional<Rigid3d> prev = pose_at(prev_time);
  const std::optional<Rigid3d> cur = pose_at(cur_time);
  if (!prev.has_value() || !cur.has_value()) return std::nullopt;
  return cur->Inverse() * *prev;
}

Trajectory ReadTrajectory(const std::string& path,
                          std::vector<std::string>* remarks) {
  Trajectory trajectory;
  int doubled = 0;
  int first_line = 0;  // line number of the first duplicate
  for (const TextLine& line : ReadTextTable(path)) {
    const StampedPose pose = ParsePose(line, path);
    if (!trajectory.empty() && pose.timestamp == trajectory.back().timestamp) {
      if (doubled++ == 0) first_line = line.number;
      continue;
    }
    if (!trajectory.empty() && pose.timestamp < trajectory.back().timestamp) {
      throw InputError(path, line.number,
                       "time stamp " + line.words[0] +
                           " is earlier than the previous one; sort the poses "
                           "by time");
    }
    trajectory.push_back(pose);
  }
  if (trajectory.empty()) {
    throw InputError(path +
                     ": contains no poses; each line must be timestamp tx ty "
                     "tz qx qy qz qw");
  }
  if (doubled > 0 && remarks != nullptr) {
    remarks->push_back(Format(
        "%s:%d: has the same time stamp as the previous pose; %d such pose%s "
        "left out",
        path.c_str(), first_line, doubled, doubled == 1 ? " is" : "s are"));
  }
  return trajectory;
}

std::string FormatTrajectory(const Trajectory& trajectory) {
  std::string text = "# timestamp tx ty tz qx qy qz qw\n";
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d& t = pose.world_from_cam.translation;
    const Eigen::Quaterniond& q = pose.world_from_cam.rotation;
    text += Format("%.6f", pose.timestamp);
    for (const double value :
         {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
      text += Format(" %.9f", value);
    }
    text += '\n';
  }
  return text;
}

}  // namespace rgbd_pose
