#include "frontend/tracking/color_time.h"

#include <string>
#include <utility>

namespace rgbd_pose {
namespace {

// Where both frames have stamp offsets that differ, what they make of a motion
// may be as far off as the motion, the other way: half of that each time.
constexpr int kFirstRounds = 3;

}  // namespace

void ColorTime::AddReference(const Frame& frame) {
  early_reference_.reset();
  if (ignores_stamps_ || !HasStampOffset(frame)) return;
  early_reference_ = frame;
  early_reference_->gray = frame.gray.clone();
  early_reference_->depth = frame.depth.clone();
  early_reference_->color.release();
}

const PreparedFrame* ColorTime::Follow(const PreparedFrame& measured,
                                       const RecentMotion& known,
                                       double interval, bool once,
                                       Keyframe* reference,
                                       const Track& track) {
  const auto frame = [&] {
    return moved_ == nullptr ? &measured : moved_.get();
  };
  moved_ = Undo(measured, known);
  std::optional<Rigid3d> found = track(*frame());
  const int rounds = once ? 0 : early_reference_.has_value() ? kFirstRounds : 1;
  Rigid3d motion = found.value_or(Rigid3d());
  for (int round = 0; found.has_value() && round < rounds; ++round) {
    const RecentMotion velocity(motion, interval);
    const bool has_mended = MendReference(velocity, reference);
    auto better = Undo(measured, velocity);
    if (better != nullptr) moved_ = std::move(better);
    if (!has_mended && moved_ == nullptr) break;
    found = track(*frame());
    if (!found.has_value()) break;
    motion = motion * RecentMotion(motion.Inverse() * *found, 1.0).During(0.5);
  }
  early_reference_.reset();
  return found.has_value() ? frame() : nullptr;
}

std::unique_ptr<const PreparedFrame> ColorTime::Undo(
    const PreparedFrame& measured, const RecentMotion& motion) {
  return ignores_stamps_ ? nullptr : offset_.Undo(measured, motion);
}

bool ColorTime::MendReference(const RecentMotion& motion, Keyframe* reference) {
  if (!early_reference_.has_value()) return false;
  const auto measured = tracker_->Prepare(*early_reference_);
  const auto moved = Undo(*measured, motion);
  if (moved == nullptr) return false;
  std::string why_not;
  auto mended = tracker_->MakeReference(*moved, nullptr, nullptr, &why_not);
  if (mended == nullptr) return false;
  reference->reference = std::move(mended);
  reference->place = std::make_unique<Place>(*moved, reference->id);
  return true;
}

}  // namespace rgbd_pose
