#include <algorithm>
#include <exception>
#include <utility>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "frontend/bags/bag_topics.h"
#include "frontend/bags/ros_image.h"
#include "frontend/bags/ros_messages.h"
#include "frontend/bags/transform_tree.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/image_pairing.h"
#include "frontend/sources/source_kinds.h"

namespace rgbd_pose {
namespace {

constexpr char kWorld[] = "world";

std::string Seconds(double seconds) { return Format("%.6f s", seconds); }

CameraSetup Setup(BagReader* bag, const BagTopics& topics,
                  const SourceOptions& options) {
  return ChooseCamera(options,
                      CameraOfBag(bag, topics, options.camera.has_value()));
}

class BagSource final : public FrameSource {
 public:
  BagSource(std::unique_ptr<BagReader> bag, const SourceOptions& options)
      : bag_(std::move(bag)),
        topics_(ChooseTopics(bag_.get(), options.topics)),
        max_time_difference_(options.max_time_difference),
        assembly_(Setup(bag_.get(), topics_, options), options.keep_color),
        pairing_(options.max_time_difference) {
    std::vector<int> wanted = topics_.transforms;
    wanted.push_back(topics_.color);
    wanted.push_back(topics_.depth);
    bag_->Select(wanted);
  }

  std::optional<RgbdFrame> Next() override {
    if (is_over_) return std::nullopt;
    do {
      if (damage_ != nullptr) {
        return RgbdFrame{last_stamp_,
                         [error = std::exchange(damage_, nullptr)]() -> Frame {
                           std::rethrow_exception(error);
                         }};
      }
      if (std::optional<StampedPair> pair = pairing_.Take()) {
        return MakeFrame(*pair);
      }
    } while (ReadOn());
    is_over_ = true;
    if (error_ != nullptr) std::rethrow_exception(error_);
    if (num_frames_ > 0) return std::nullopt;
    throw InputError(bag_->path() + ": none of " + std::to_string(num_color_) +
                     " colour images is within " +
                     Seconds(max_time_difference_) + " of one of " +
                     std::to_string(num_depth_) +
                     " depth images; the first ones are " +
                     Seconds(first_depth_ - first_color_) +
                     " apart; do they use the same clock?");
  }

  const RgbdCamera& camera() const override { return assembly_.camera(); }

  Trajectory ground_truth() const override {
    return transforms_.PathOf(kWorld, color_frame_);
  }

  int unmatched_color() const override { return pairing_.unmatched_color(); }

  std::vector<std::string> remarks() const override {
    std::vector<std::string> lines;
    const std::string& color = bag_->topics()[topics_.color].name;
    const std::string& depth = bag_->topics()[topics_.depth].name;
    if (topics_.had_choice) {
      lines.push_back(bag_->path() + ": colour is " + color + ", depth " +
                      depth + "; choose others with topics=COLOUR,DEPTH");
    }
    if (IsCalledRegistered(depth) && num_color_ > 0 && num_depth_ > 0 &&
        color_frame_ != depth_frame_) {
      lines.push_back(
          bag_->path() + ": " + depth +
          " is assumed to be registered to colour because of its name, but its "
          "frame is '" +
          depth_frame_ + "', that of colour '" + color_frame_ + "'");
    }
    if (pairing_.same_stamp() > 0) {
      lines.push_back(SameStampRemark(bag_->path(), pairing_.same_stamp()));
    }
    if (pairing_.late() > 0) {
      lines.push_back(
          bag_->path() + ": " + std::to_string(pairing_.late()) +
          " depth images are more than " +
          std::to_string(static_cast<int>(ImagePairing::kMaxSeconds)) +
          " s or " + std::to_string(ImagePairing::kMaxBytes >> 20) +
          " MiB behind colour images of the same time; rewrite the bag in the "
          "order of its header stamps");
    }
    return lines;
  }

 private:
  // Reads the next message. Returns false if the bag has ended before.
  bool ReadOn() {
    if (is_read_) return false;
    std::optional<BagMessage> message;
    try {
      message = bag_->Next();
    } catch (const InputError&) {
      error_ = std::current_exception();  // rethrown after the frames before it
    }
    if (!message.has_value()) {
      is_read_ = true;
      pairing_.Finish();
      return true;
    }
    try {
      Add(*message);
    } catch (const InputError&) {
      damage_ = std::current_exception();
    }
    return true;
  }

  void Add(const BagMessage& message) {
    const bool is_color = message.topic == topics_.color;
    if (!is_color && message.topic != topics_.depth) {
      for (const RosTransform& transform :
           ReadMessage(*bag_, message, ReadRosTransforms)) {
        transforms_.Add(std::string(transform.header.frame_id),
                        std::string(transform.child_frame_id),
                        transform.header.stamp, transform.parent_from_child);
      }
      return;
    }
    const RosHeader header = ReadImageOf(*bag_, message).header;
    // Without a stamp in the header, the time of recording is used.
    const double stamp = header.stamp > 0.0 ? header.stamp : message.received;
    if (!is_color) {
      if (num_depth_++ == 0) {
        first_depth_ = stamp;
        depth_frame_ = header.frame_id;
      }
      pairing_.AddDepth({stamp, message.bytes});
      return;
    }
    if (num_color_++ == 0) {
      first_color_ = stamp;
      color_frame_ = header.frame_id;
    }
    if (!pairing_.AddColor({stamp, message.bytes})) {
      throw InputError(NameOf(message.topic, stamp) + ": is more than " +
                       std::to_string(ImagePairing::kWindow) +
                       " images out of order; rewrite the bag in the order of "
                       "its header stamps");
    }
  }

  RgbdFrame MakeFrame(const StampedPair& pair) {
    const int index = num_frames_++;
    last_stamp_ = pair.color.stamp;
    return {last_stamp_, [this, index, pair] {
              const std::string color_name =
                  NameOf(topics_.color, pair.color.stamp);
              const std::string depth_name =
                  NameOf(topics_.depth, pair.depth.stamp);
              cv::Mat color;
              const cv::Mat gray = DecodeRosGray(
                  ReadImageOf(*bag_, {topics_.color, 0.0, pair.color.message}),
                  color_name, assembly_.keep_color() ? &color : nullptr);
              const cv::Mat depth = DecodeRosDepth(
                  ReadImageOf(*bag_, {topics_.depth, 0.0, pair.depth.message}),
                  depth_name, assembly_.camera().depth_scale);
              Frame frame = assembly_.Make({gray, color_name}, color,
                                           {depth, depth_name});
              frame.index = index;
              frame.timestamp = pair.color.stamp;
              frame.depth_delay = pair.depth.stamp - pair.color.stamp;
              return frame;
            }};
  }

  std::string NameOf(int topic, double stamp) const {
    return bag_->path() + ": " + bag_->topics()[topic].name + " at " +
           Seconds(stamp);
  }

  std::unique_ptr<BagReader> bag_;
  BagTopics topics_;
  double max_time_difference_;
  std::string color_frame_;  // frame_id of the first image
  std::string depth_frame_;
  FrameAssembly assembly_;
  ImagePairing pairing_;
  TransformTree transforms_;
  int num_color_ = 0;
  int num_depth_ = 0;
  int num_frames_ = 0;
  double first_color_ = 0.0;  // stamps, s
  double first_depth_ = 0.0;
  double last_stamp_ = 0.0;    // of the last frame
  std::exception_ptr damage_;  // error of the last message
  std::exception_ptr error_;   // error of the bag
  bool is_read_ = false;       // to its end
  bool is_over_ = false;
};

}  // namespace

std::unique_ptr<FrameSource> OpenBagSource(std::unique_ptr<BagReader> bag,
                                           const SourceOptions& options) {
  return std::make_unique<BagSource>(std::move(bag), options);
}

}  // namespace rgbd_pose
