#include "frontend/files/video_file.h"

#include <cstdlib>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// Opens a video including the images that an edit list hides. OpenCV takes this
// option of FFmpeg from the environment only.
bool OpenWhole(const std::string& path, cv::VideoCapture* video) {
  static std::mutex one_at_a_time;
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  constexpr char kOptions[] = "OPENCV_FFMPEG_CAPTURE_OPTIONS";
  const char* const set = std::getenv(kOptions);
  const std::string before = set == nullptr ? "" : set;
  setenv(kOptions, "ignore_editlist;1", 1);
  // Prevents FFmpeg from printing its own messages about damaged files.
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  const bool is_open = video->open(path, cv::CAP_FFMPEG);
  if (set == nullptr) {
    unsetenv(kOptions);
  } else {
    setenv(kOptions, before.c_str(), 1);
  }
  return is_open;
}

}  // namespace

VideoFile::VideoFile(const std::string& path) : path_(path) {
  if (!PathExists(path)) {
    throw InputError(path + ": missing; copy the whole folder");
  }
  if (!OpenWhole(path, &video_)) {
    throw InputError(path +
                     ": cannot be read as a video; is it damaged or cut off?");
  }
  video_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0.0);
  size_ = {static_cast<int>(video_.get(cv::CAP_PROP_FRAME_WIDTH)),
           static_cast<int>(video_.get(cv::CAP_PROP_FRAME_HEIGHT))};
  count_ = static_cast<int>(video_.get(cv::CAP_PROP_FRAME_COUNT));
}

std::shared_ptr<cv::Mat> VideoFile::Next() {
  const std::lock_guard<std::mutex> lock(mutex_);
  TakeOut();
  if (!video_.grab()) {
    video_.release();  // what came after would have the wrong number
    throw InputError(path_ + ": only " + std::to_string(num_read_) + " of " +
                     std::to_string(count_) +
                     " images can be decoded; is it damaged or cut off?");
  }
  ++num_read_;
  auto place = std::make_shared<cv::Mat>();
  last_ = place;
  return place;
}

const cv::Mat& VideoFile::At(const std::shared_ptr<cv::Mat>& place) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (place->empty()) TakeOut();
  if (place->empty()) throw InputError(path_ + ": an image is damaged");
  return *place;
}

void VideoFile::TakeOut() {
  const std::shared_ptr<cv::Mat> place = last_.lock();
  if (place != nullptr && place->empty()) video_.retrieve(*place);
}

}  // namespace rgbd_pose
