#include "frontend/tracking/stamp_offset.h"

#include <typeinfo>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

// In 50 ms a hand does not go farther; a wrong estimate does.
constexpr double kMaxTurn = 0.3;   // rad
constexpr double kMaxShift = 0.2;  // m

}  // namespace

std::unique_ptr<const PreparedFrame> StampOffset::Undo(
    const PreparedFrame& frame, const RecentMotion& motion) {
  if (!HasStampOffset(frame) || !motion.is_known()) return nullptr;
  const Rigid3d color_from_depth = motion.During(-frame.depth_delay);
  if (color_from_depth.Angle() > kMaxTurn ||
      color_from_depth.translation.norm() > kMaxShift) {
    return nullptr;
  }
  std::unique_ptr<PreparedFrame> copy = frame.Copy();
  const PreparedFrame& copied = *copy;
  if (typeid(copied) != typeid(frame)) {
    throw InputError(
        "a frontend's prepared frame needs a Copy of its own type to undo the "
        "offset between the time stamps of colour and depth");
  }
  copy->depth = mover_.Move(frame, color_from_depth);
  copy->depth_delay = 0.0;
  return copy;
}

}  // namespace rgbd_pose
