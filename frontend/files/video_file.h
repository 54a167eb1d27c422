#pragma once

#include <memory>
#include <mutex>
#include <opencv2/videoio.hpp>
#include <string>

namespace rgbd_pose {

// A video that is read image by image, because random access is slow and
// inexact. Skipped images are decoded, since later images depend on them, but
// not converted to pictures, which saves half the time.
class VideoFile {
 public:
  // Opens all images of the file, including those that its edit list hides,
  // without rotating them. Throws InputError if it is missing or no video.
  explicit VideoFile(const std::string& path);

  const std::string& path() const { return path_; }
  cv::Size size() const { return size_; }
  int count() const { return count_; }        // number of images in the header
  int num_read() const { return num_read_; }  // number of calls of Next

  // Advances to the next image and returns a handle for At. If it is released
  // before the next call, the image is skipped. Throws InputError on damage.
  std::shared_ptr<cv::Mat> Next();

  // The image of a handle: CV_8UC3 (BGR). Thread-safe. InputError on damage.
  const cv::Mat& At(const std::shared_ptr<cv::Mat>& place);

 private:
  void TakeOut();

  std::string path_;
  cv::Size size_;
  int count_ = 0;
  std::mutex mutex_;  // guards the members below
  cv::VideoCapture video_;
  std::weak_ptr<cv::Mat> last_;  // the last handle of Next
  int num_read_ = 0;
};

}  // namespace rgbd_pose
