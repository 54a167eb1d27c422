#include "frontend/sources/frame_range.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// One end of a range: a number, followed by s if it is a time.
struct End {
  bool is_given = false;
  bool is_time = false;
  double value = 0.0;
};

// Returns false if the text is invalid; if it is empty, no end is given.
bool ParseEnd(std::string_view text, End* end) {
  if (text.empty()) return true;
  end->is_given = true;
  end->is_time = text.back() == 's';
  if (end->is_time) text.remove_suffix(1);
  const char* const stop = text.data() + text.size();
  const auto [rest, error] =
      std::from_chars(text.data(), stop, end->value, std::chars_format::fixed);
  const bool is_number =
      end->is_time || (end->value == std::floor(end->value) &&
                       end->value < std::numeric_limits<int>::max());
  return error == std::errc() && rest == stop && std::isfinite(end->value) &&
         is_number;
}

bool Parse(std::string_view text, FrameRange* range) {
  const std::vector<std::string> parts = SplitText(text, ':');
  const std::vector<std::string> ends = SplitText(parts[0], '-');
  End first;
  End last;
  if (parts.size() > 2 || ends.size() != 2 || !ParseEnd(ends[0], &first) ||
      !ParseEnd(ends[1], &last) || (!first.is_given && !last.is_given)) {
    return false;
  }
  if (parts.size() == 2) {
    range->step = ParseWhole(parts[1]).value_or(0);
    if (range->step < 1) return false;
  }
  const bool is_time = first.is_given ? first.is_time : last.is_time;
  if (first.is_given && last.is_given &&
      (first.is_time != last.is_time || last.value < first.value)) {
    return false;
  }
  if (is_time) {
    range->begin_s = first.value;
    if (last.is_given) range->end_s = last.value;
  } else {
    range->first = static_cast<int>(first.value);
    if (last.is_given) range->last = static_cast<int>(last.value);
  }
  return true;
}

InputError NoneOf(size_t frames) {
  return InputError("frames: the recording has only " + std::to_string(frames) +
                    " frames, none of them in this range");
}

// The frames of another source that are in a range.
class PartialSource final : public FrameSource {
 public:
  PartialSource(std::unique_ptr<FrameSource> whole, const FrameRange& range)
      : whole_(std::move(whole)), picker_{range} {}

  std::optional<RgbdFrame> Next() override {
    while (!picker_.IsOver()) {
      std::optional<RgbdFrame> next = whole_->Next();
      if (!next.has_value()) break;
      Keep(next->imu);
      if (!picker_.Takes(next->timestamp)) continue;
      next->imu = std::exchange(imu_, {});
      return next->WithIndex(num_taken_++);
    }
    if (num_taken_ == 0 && picker_.number > 0) throw NoneOf(picker_.number);
    return std::nullopt;
  }

  const RgbdCamera& camera() const override { return whole_->camera(); }

  std::vector<double> timestamps() const override {
    std::vector<double> part;
    Picker picker{picker_.range};
    for (const double timestamp : whole_->timestamps()) {
      if (picker.IsOver()) break;
      if (picker.Takes(timestamp)) part.push_back(timestamp);
    }
    return part;
  }

  Trajectory ground_truth() const override { return whole_->ground_truth(); }

  std::optional<ImuSensor> imu() const override { return whole_->imu(); }

  // These refer to the whole recording.
  int unmatched_color() const override { return whole_->unmatched_color(); }
  int dropped() const override { return whole_->dropped(); }
  std::vector<std::string> remarks() const override {
    return whole_->remarks();
  }

 private:
  // Decides for one frame after the other whether it is in the range.
  struct Picker {
    FrameRange range;
    double start = 0.0;
    double after_s = 0.0;
    int number = 0;
    int num_in = 0;

    // Whether the next frame is selected.
    bool Takes(double timestamp) {
      if (number++ == 0) start = timestamp;
      after_s = timestamp - start;
      const bool is_in = number > range.first && number - 1 <= range.last &&
                         after_s >= range.begin_s && after_s <= range.end_s;
      return is_in && num_in++ % range.step == 0;
    }
    bool IsOver() const { return number > range.last || after_s > range.end_s; }
  };

  // Keeps inertial samples for the next frame of the part: all those after its
  // frame before, but only a second of what is before a part that does not
  // begin with the recording.
  void Keep(const std::vector<ImuSample>& samples) {
    constexpr double kBeforeFirst = 1.0;  // s
    imu_.insert(imu_.end(), samples.begin(), samples.end());
    const FrameRange& range = picker_.range;
    const bool is_from_start = range.first == 0 && range.begin_s == 0.0;
    if (num_taken_ > 0 || is_from_start || imu_.empty()) return;
    const double earliest = imu_.back().stamp - kBeforeFirst;
    imu_.erase(imu_.begin(), std::find_if(imu_.begin(), imu_.end(),
                                          [earliest](const ImuSample& sample) {
                                            return sample.stamp >= earliest;
                                          }));
  }

  std::unique_ptr<FrameSource> whole_;
  Picker picker_;
  int num_taken_ = 0;
  std::vector<ImuSample> imu_;  // of frames that were not taken
};

}  // namespace

FrameRange ParseFrameRange(const std::string& text) {
  FrameRange range;
  if (text.empty() || Parse(text, &range)) return range;
  throw InputError("frames '" + text +
                   "': is not a valid range; give first-last such as 0-99, "
                   "100-400:2 (every second) or 100-, or seconds from the "
                   "start such as 2.5s-10s");
}

std::unique_ptr<FrameSource> PartOf(std::unique_ptr<FrameSource> whole,
                                    const FrameRange& range) {
  const size_t frames = whole->timestamps().size();
  auto part = std::make_unique<PartialSource>(std::move(whole), range);
  if (frames > 0 && part->timestamps().empty()) throw NoneOf(frames);
  return part;
}

FrameSelection::FrameSelection(const std::string& flag,
                               const std::string& text) {
  if (text.empty()) return;
  if (text == "all") {
    ranges_ = {FrameRange()};
    return;
  }
  for (const std::string& item : SplitText(text, ',')) {
    FrameRange& range = ranges_.emplace_back();
    // A number alone is a range of one frame. Open ranges and times are valid
    // for parts of recordings only.
    const bool is_number = item.find('-') == std::string::npos;
    if (!Parse(is_number ? item + "-" + item : item, &range) ||
        item[0] == '-' || range.last == FrameRange().last) {
      throw InputError(
          "--" + flag + "=" + text + ": '" + item +
          "' is not a frame number, first-last or first-last:step (first <= "
          "last, step >= 1); give a list such as 10,20-40,100-200:10, or all");
    }
  }
}

int FrameSelection::LastBegin() const {
  int last = -1;
  for (const FrameRange& range : ranges_) last = std::max(last, range.first);
  return last;
}

bool FrameSelection::Contains(int index) const {
  return std::any_of(ranges_.begin(), ranges_.end(),
                     [index](const FrameRange& r) {
                       return index >= r.first && index <= r.last &&
                              (index - r.first) % r.step == 0;
                     });
}

}  // namespace rgbd_pose
