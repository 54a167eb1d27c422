#include "apps/shell/frame_selection.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <system_error>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// Take something off the front of the text; false if it is not there.
bool Take(char mark, std::string_view* text) {
  if (text->empty() || text->front() != mark) return false;
  text->remove_prefix(1);
  return true;
}

bool TakeNumber(std::string_view* text, int* value) {
  const char* begin = text->data();
  const auto [end, error] =
      std::from_chars(begin, begin + text->size(), *value);
  if (error != std::errc()) return false;
  text->remove_prefix(end - begin);
  return true;
}

}  // namespace

FrameSelection::FrameSelection(const std::string& flag,
                               const std::string& text) {
  if (text.empty()) return;
  if (text == "all") {
    ranges_ = {{0, std::numeric_limits<int>::max(), 1}};
    return;
  }
  for (const std::string& item : SplitText(text, ',')) {
    const std::optional<Range> range = ParseRange(item);
    if (!range.has_value()) {
      throw InputError(
          "--" + flag + "=" + text + ": '" + item +
          "' is no frame number, first-last or first-last:step (first <= "
          "last, step >= 1); give a list such as 10,20-40,100-200:10, or all");
    }
    ranges_.push_back(*range);
  }
}

std::optional<FrameSelection::Range> FrameSelection::ParseRange(
    std::string_view text) {
  Range range;
  if (!TakeNumber(&text, &range.first)) return std::nullopt;
  range.last = range.first;
  if (Take('-', &text)) {
    if (!TakeNumber(&text, &range.last)) return std::nullopt;
    if (Take(':', &text) && !TakeNumber(&text, &range.step)) {
      return std::nullopt;
    }
  }
  const bool makes_sense =
      range.first >= 0 && range.last >= range.first && range.step >= 1;
  if (!makes_sense || !text.empty()) return std::nullopt;
  return range;
}

bool FrameSelection::Contains(int index) const {
  return std::any_of(ranges_.begin(), ranges_.end(), [index](const Range& r) {
    return index >= r.first && index <= r.last &&
           (index - r.first) % r.step == 0;
  });
}

}  // namespace rgbd_pose
