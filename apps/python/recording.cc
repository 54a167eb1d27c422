#include "apps/python/recording.h"

#include "core/util/input_error.h"

namespace rgbd_pose {

std::vector<double> Recording::timestamps() const {
  const std::lock_guard<std::mutex> lock(*mutex_);
  return source_->timestamps();
}

std::shared_ptr<FrameSource> Recording::Begin() {
  if (is_used_) source_ = open_(false);
  is_used_ = true;
  return source_;
}

Frame Recording::Read(int index) {
  std::optional<RgbdFrame> frame;
  std::shared_ptr<FrameSource> source;
  {
    const std::lock_guard<std::mutex> lock(*mutex_);
    if (picked_ == nullptr || index < next_) {
      picked_ = open_(false);
      next_ = 0;
    }
    for (source = picked_; next_ <= index; ++next_) frame = source->Next();
  }
  if (!frame.has_value()) {
    throw InputError("the recording ends before frame " +
                     std::to_string(index));
  }
  return frame->read();
}

std::vector<ImuSample> Recording::ReadImu() const {
  std::vector<ImuSample> samples;
  if (!source_->imu().has_value()) return samples;
  const std::unique_ptr<FrameSource> source = open_(false);
  while (const std::optional<RgbdFrame> frame = source->Next()) {
    samples.insert(samples.end(), frame->imu.begin(), frame->imu.end());
  }
  return samples;
}

}  // namespace rgbd_pose
