#pragma once

#include <memory>
#include <mutex>
#include <opencv2/videoio.hpp>
#include <string>

namespace rgbd_pose {

// A video that is read image after image, as random access is slow and inexact.
// What nobody waits for is decoded, since later images build on it, but not
// made a picture of: that takes half the time.
class VideoFile {
 public:
  // All images of the file, also those that its edit list hides from players,
  // as they were taken, whatever way up a player is to show them. Throws
  // InputError for a file that is missing or no video.
  explicit VideoFile(const std::string& path);

  const std::string& path() const { return path_; }
  cv::Size size() const { return size_; }
  int count() const { return count_; }  // of images, as the file says

  // The place of the next image, not there yet. Who lets go of it before the
  // next call gives the image up. Throws InputError where it cannot be decoded.
  std::shared_ptr<cv::Mat> Next();

  // The image at a place: CV_8UC3, blue, green, red. From any thread. Throws
  // InputError if it is damaged.
  const cv::Mat& At(const std::shared_ptr<cv::Mat>& place);

 private:
  void TakeOut();

  std::string path_;
  cv::Size size_;
  int count_ = 0;
  std::mutex mutex_;  // of what follows
  cv::VideoCapture video_;
  std::weak_ptr<cv::Mat> last_;  // place that Next gave
  int num_read_ = 0;
};

}  // namespace rgbd_pose
