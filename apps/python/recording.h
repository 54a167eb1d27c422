#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/inertial/imu_sample.h"
#include "frontend/frame/frame.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// A recording of any kind. Each iteration reads it from the start.
class Recording {
 public:
  // Opens the recording from its start, with or without the colours.
  using Open = std::function<std::unique_ptr<FrameSource>(bool keep_color)>;

  // Throws InputError if it cannot be opened.
  Recording(std::string path, Open open)
      : path_(std::move(path)), open_(std::move(open)), source_(open_(false)) {}

  const std::string& path() const { return path_; }
  const Open& open() const { return open_; }
  const FrameSource& source() const { return *source_; }
  const std::shared_ptr<std::mutex>& mutex() const { return mutex_; }

  // The time stamps of all frames; empty if they are not known in advance.
  std::vector<double> timestamps() const;

  std::shared_ptr<FrameSource> Begin();

  // Frame `index` from 0, by a reading of its own: forward from the last one
  // if that was earlier. Call it without the GIL.
  Frame Read(int index);

  // All inertial samples, by a reading of its own. Call it without the GIL.
  std::vector<ImuSample> ReadImu() const;

 private:
  std::string path_;
  Open open_;
  std::shared_ptr<FrameSource> source_;
  std::shared_ptr<std::mutex> mutex_ = std::make_shared<std::mutex>();
  bool is_used_ = false;
  std::shared_ptr<FrameSource> picked_;  // null: no frame was picked
  int next_ = 0;                         // number of the next frame of picked_
};

}  // namespace rgbd_pose
