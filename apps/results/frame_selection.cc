#include "apps/results/frame_selection.h"

#include <algorithm>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// A number alone is a range of one frame.
FrameRange ParseItem(const std::string& item) {
  const bool is_number = item.find('-') == std::string::npos;
  const FrameRange range =
      ParseFrameRange(is_number ? item + "-" + item : item);
  // Without an end, as parts of recordings may be, and of times.
  if (item[0] == '-' || range.last == FrameRange().last) {
    throw InputError("open");
  }
  return range;
}

}  // namespace

FrameSelection::FrameSelection(const std::string& flag,
                               const std::string& text) {
  if (text.empty()) return;
  if (text == "all") {
    ranges_ = {FrameRange()};
    return;
  }
  for (const std::string& item : SplitText(text, ',')) {
    try {
      ranges_.push_back(ParseItem(item));
    } catch (const InputError&) {
      throw InputError(
          "--" + flag + "=" + text + ": '" + item +
          "' is no frame number, first-last or first-last:step (first <= "
          "last, step >= 1); give a list such as 10,20-40,100-200:10, or all");
    }
  }
}

bool FrameSelection::Contains(int index) const {
  return std::any_of(ranges_.begin(), ranges_.end(),
                     [index](const FrameRange& r) {
                       return index >= r.first && index <= r.last &&
                              (index - r.first) % r.step == 0;
                     });
}

}  // namespace rgbd_pose
