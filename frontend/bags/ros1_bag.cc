#include "frontend/bags/ros1_bag.h"

#include "core/util/input_error.h"
#ifdef RGBD_POSE_HAS_ROSBAG
#include <console_bridge/console.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <filesystem>
#endif

namespace rgbd_pose {

#ifdef RGBD_POSE_HAS_ROSBAG

namespace {

// Keeps the library from printing while this lives: what it says is in its
// exceptions, too.
class Silence {
 public:
  Silence() : former_(console_bridge::getOutputHandler()) {
    console_bridge::noOutputHandler();
  }
  ~Silence() { console_bridge::useOutputHandler(former_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  console_bridge::OutputHandler* former_;
};

// Calls what may throw exceptions of the library, which are InputErrors here.
template <typename Call>
auto Guarded(const std::string& path, Call call) {
  const Silence silence;
  try {
    return call();
  } catch (const InputError&) {
    throw;
  } catch (const rosbag::BagUnindexedException&) {
    throw InputError(path +
                     ": has no index: its recorder was not ended properly; "
                     "`rosbag reindex` makes one");
  } catch (const std::exception& error) {
    throw InputError(path + ": cannot be read as a ROS 1 bag: " + error.what() +
                     "; it is damaged or cut off: copy it again, or try "
                     "`rosbag reindex`");
  }
}

BagMessage MessageOf(const rosbag::MessageInstance& message, int topic) {
  auto bytes = std::make_shared<std::string>(message.size(), '\0');
  ros::serialization::OStream stream(reinterpret_cast<uint8_t*>(bytes->data()),
                                     static_cast<uint32_t>(bytes->size()));
  message.write(stream);
  return {topic, message.getTime().toSec(), std::move(bytes)};
}

class Ros1Bag final : public BagReader {
 public:
  explicit Ros1Bag(const std::string& path) : path_(path) {
    std::error_code error;
    if (std::filesystem::file_size(path, error) == 0 && !error) {
      throw InputError(path + ": is empty; copy it again");
    }
    Guarded(path_, [&] {
      bag_.open(path, rosbag::bagmode::Read);
      rosbag::View all(bag_);
      for (const rosbag::ConnectionInfo* info : all.getConnections()) {
        // A topic has a connection for each that published it.
        if (places_.emplace(info->topic, topics_.size()).second) {
          topics_.push_back({info->topic, info->datatype});
        }
      }
    });
  }

  const std::string& path() const override { return path_; }
  WireFormat format() const override { return WireFormat::kRos1; }
  const std::vector<BagTopic>& topics() const override { return topics_; }

  std::vector<BagMessage> First(int topic, int count) override {
    return Guarded(path_, [&] {
      std::vector<BagMessage> first;
      rosbag::View view(bag_, rosbag::TopicQuery(topics_[topic].name));
      for (const rosbag::MessageInstance& message : view) {
        if (static_cast<int>(first.size()) == count) break;
        first.push_back(MessageOf(message, topic));
      }
      return first;
    });
  }

  void Select(const std::vector<int>& topics) override {
    Guarded(path_, [&] {
      std::vector<std::string> names;
      for (const int topic : topics) names.push_back(topics_[topic].name);
      view_ = std::make_unique<rosbag::View>(bag_, rosbag::TopicQuery(names));
      next_ = view_->begin();
    });
  }

  std::optional<BagMessage> Next() override {
    return Guarded(path_, [&]() -> std::optional<BagMessage> {
      if (view_ == nullptr || next_ == view_->end()) return std::nullopt;
      const rosbag::MessageInstance& message = *next_;
      BagMessage taken =
          MessageOf(message, static_cast<int>(places_.at(message.getTopic())));
      ++next_;
      return taken;
    });
  }

 private:
  std::string path_;
  rosbag::Bag bag_;
  std::vector<BagTopic> topics_;
  std::map<std::string, size_t> places_;  // of topics by name
  std::unique_ptr<rosbag::View> view_;    // of those selected
  rosbag::View::iterator next_;
};

}  // namespace

std::unique_ptr<BagReader> OpenRos1Bag(const std::string& path) {
  return std::make_unique<Ros1Bag>(path);
}

#else

std::unique_ptr<BagReader> OpenRos1Bag(const std::string& path) {
  throw InputError(path +
                   ": this build reads no ROS 1 bags; install "
                   "librosbag-storage-dev (scripts/install_dependencies "
                   "formats) and build again");
}

#endif

}  // namespace rgbd_pose
