#pragma once

#include <any>
#include <memory>
#include <mutex>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A frame with data derived from its gray levels (pyramids, descriptors). Each
// item is computed once, at the first request, and shared by all copies. The
// images are shared too and must not change. Nothing derived may depend on
// depth, as its correction depends on the velocity. Thread-safe.
class PreparedFrame : public Frame {
 public:
  PreparedFrame() = default;
  // Shares the images of the frame; nothing is derived yet.
  explicit PreparedFrame(const Frame& frame) : Frame(frame) {}

  // A copy with another velocity, which shares the derived data.
  PreparedFrame WithTwist(const std::optional<Twist>& velocity) const {
    PreparedFrame copy = *this;
    copy.twist = velocity;
    return copy;
  }

  // The derived data T(*this, arguments...). The same object for equal
  // arguments, which lives as long as any copy of the frame.
  template <typename T, typename... Arguments>
  const T& Derived(const Arguments&... arguments) const {
    using Made = std::pair<std::tuple<Arguments...>, std::shared_ptr<const T>>;
    const std::tuple<Arguments...> wanted(arguments...);
    const std::lock_guard<std::recursive_mutex> lock(derived_->mutex);
    for (const std::any& any : derived_->all) {
      const auto* made = std::any_cast<Made>(&any);
      if (made != nullptr && made->first == wanted) return *made->second;
    }
    const auto value = std::make_shared<const T>(*this, arguments...);
    derived_->all.push_back(Made(wanted, value));
    return *value;
  }

 private:
  struct DerivedData {
    std::recursive_mutex mutex;  // computing one item may request another
    std::vector<std::any> all;
  };

  std::shared_ptr<DerivedData> derived_ = std::make_shared<DerivedData>();
};

}  // namespace rgbd_pose
