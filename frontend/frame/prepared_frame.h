#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <tuple>
#include <vector>

#include "frontend/frame/frame.h"

namespace rgbd_pose {

// A frame with what is made of its gray levels (pyramids, descriptors): each
// once, by whoever asks first, and shared by all copies. It shares the images,
// which must stay as they are for as long as it is in use. Nothing that depends
// on depth is kept: when that was taken, only the motion tells. May be asked
// from several threads.
class PreparedFrame : public Frame {
 public:
  // With nothing made yet.
  PreparedFrame() : PreparedFrame(Frame()) {}
  explicit PreparedFrame(const Frame& frame)
      : Frame(frame), derived_(std::make_shared<DerivedData>()) {}

  // The same with another velocity.
  PreparedFrame WithTwist(const std::optional<Twist>& velocity) const {
    PreparedFrame copy = *this;
    copy.twist = velocity;
    return copy;
  }

  // The T of its gray levels, T(*this, arguments...): the same object for equal
  // arguments, as long as a copy of the frame lives.
  template <typename T, typename... Arguments>
  const T& Derived(const Arguments&... arguments) const {
    using Made = DerivedOf<T, Arguments...>;
    const std::tuple<Arguments...> wanted(arguments...);
    const std::lock_guard<std::recursive_mutex> lock(derived_->mutex);
    for (const std::unique_ptr<AnyDerived>& any : derived_->all) {
      const auto* made = dynamic_cast<const Made*>(any.get());
      if (made != nullptr && made->arguments == wanted) return made->value;
    }
    auto made = std::make_unique<Made>(*this, arguments...);
    const T& value = made->value;
    derived_->all.push_back(std::move(made));
    return value;
  }

 private:
  struct AnyDerived {
    virtual ~AnyDerived() = default;
  };
  template <typename T, typename... Arguments>
  struct DerivedOf final : AnyDerived {
    explicit DerivedOf(const PreparedFrame& frame, const Arguments&... all)
        : arguments(all...), value(frame, all...) {}
    std::tuple<Arguments...> arguments;
    T value;
  };
  struct DerivedData {
    std::recursive_mutex mutex;  // making one may ask for another
    std::vector<std::unique_ptr<AnyDerived>> all;
  };

  std::shared_ptr<DerivedData> derived_;
};

}  // namespace rgbd_pose
