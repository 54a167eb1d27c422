#include "frontend/sources/approximate_time_sync.h"

#include <optional>
#include <utility>

#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {

StreamPair ApproximateTimeSync::Next(const std::string& name,
                                     const std::function<StreamImage()>& read) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point began = Clock::now();
  std::optional<StreamImage> color;
  std::optional<StreamImage> depth;
  while (true) {
    StreamImage image = read();
    if (image.is_color && color.has_value()) ++unmatched_color_;
    (image.is_color ? color : depth) = std::move(image);
    if (color.has_value() && depth.has_value()) {
      const double delay = depth->stamp - color->stamp;
      if (delay > max_time_difference_) {
        ++unmatched_color_;
        color.reset();
      } else if (delay < -max_time_difference_ ||
                 color->stamp <= last_stamp_) {  // the camera began again
        depth.reset();
      } else {
        last_stamp_ = color->stamp;
        return {std::move(*color), std::move(*depth)};
      }
    }
    if (Clock::now() - began < patience_) continue;
    const double seconds = std::chrono::duration<double>(patience_).count();
    throw InputError(Format(
        "%s: %s images came for %.3g s, but no pair of colour and depth %.3g s "
        "apart or less; does the camera give both?",
        name.c_str(), color.has_value() ? "colour" : "depth", seconds,
        max_time_difference_));
  }
}

}  // namespace rgbd_pose
