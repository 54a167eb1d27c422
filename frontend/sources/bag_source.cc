#include <exception>
#include <utility>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "frontend/bags/bag_topics.h"
#include "frontend/bags/ros_image.h"
#include "frontend/bags/transform_tree.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/image_pairing.h"
#include "frontend/sources/imu_beside.h"
#include "frontend/sources/imu_feed.h"
#include "frontend/sources/source_kinds.h"

namespace rgbd_pose {
namespace {

class BagSource final : public FrameSource {
 public:
  BagSource(std::unique_ptr<BagReader> bag, const SourceOptions& options)
      : bag_(std::move(bag)),
        topics_(ChooseTopics(bag_.get(), options.topics)),
        max_time_difference_(options.max_time_difference),
        assembly_(
            ChooseCamera(options, CameraOfBag(bag_.get(), topics_,
                                              options.camera.has_value())),
            options.keep_color),
        pairing_(options.max_time_difference) {
    std::vector<std::string> wanted = topics_.transforms;
    wanted.push_back(topics_.color);
    wanted.push_back(topics_.depth);
    if (options.imu != SourceOptions::kNoImu && OpenImu(options)) {
      wanted.push_back(topics_.imu.accel);
      if (topics_.imu.is_split()) wanted.push_back(topics_.imu.gyro);
    }
    messages_ = bag_->MessagesOf(wanted);
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
      if (const auto pair = pairing_.Take()) {
        const double stamp = pair->color.timestamp;
        ReadImuFor(stamp);
        RgbdFrame frame = MakeFrame(*pair);
        frame.imu = imu_feed_.Take(stamp);
        return frame;
      }
    } while (ReadOn());
    is_over_ = true;
    if (error_ != nullptr) std::rethrow_exception(error_);
    if (num_frames_ > 0) return std::nullopt;
    throw InputError(
        bag_->path() +
        Format(": none of %d colour images is within %.6f s of one of %d depth "
               "images; the first ones are %.6f s apart; do they use the same "
               "clock?",
               color_.images, max_time_difference_, depth_.images,
               depth_.first - color_.first));
  }

  const RgbdCamera& camera() const override { return assembly_.camera(); }

  Trajectory ground_truth() const override {
    return transforms_.PathOf("world", color_.frame);
  }

  std::optional<ImuSensor> imu() const override { return imu_sensor_; }

  int unmatched_color() const override { return pairing_.unmatched_color(); }

  std::vector<std::string> remarks() const override {
    std::vector<std::string> lines;
    if (topics_.had_choice) {
      lines.push_back(bag_->path() + ": colour is " + topics_.color +
                      ", depth " + topics_.depth +
                      "; choose others with topics=COLOUR,DEPTH");
    }
    if (IsCalledRegistered(topics_.depth) && color_.images > 0 &&
        depth_.images > 0 && color_.frame != depth_.frame) {
      lines.push_back(bag_->path() + ": " + topics_.depth +
                      " is assumed to be registered to colour because of its "
                      "name, but its frame is '" +
                      depth_.frame + "', that of colour '" + color_.frame +
                      "'");
    }
    if (unstamped_ > 0) {
      lines.push_back(bag_->path() +
                      Format(": %d images have no time stamp in their headers: "
                             "the times of recording are used",
                             unstamped_));
    }
    if (!damaged_transform_.empty()) lines.push_back(damaged_transform_);
    AddImuRemarks(&lines);
    if (pairing_.same_stamp() > 0) {
      lines.push_back(SameStampRemark(bag_->path(), pairing_.same_stamp()));
    }
    if (pairing_.late() > 0) {
      lines.push_back(
          bag_->path() +
          Format(
              ": %d depth images are more than %g s or %zu MiB behind colour "
              "images of the same time; rewrite the bag in the order of its "
              "header stamps",
              pairing_.late(), ImagePairing::kMaxSeconds,
              ImagePairing::kMaxBytes >> 20));
    }
    return lines;
  }

 private:
  // What was read of an image topic.
  struct Stream {
    int images = 0;
    double first = 0.0;  // stamp of the first image, s
    std::string frame;   // frame_id of the first image
  };

  // Prepares to read the inertial sensor. Returns false if there is none.
  bool OpenImu(const SourceOptions& options) {
    if (topics_.imu.accel.empty()) {
      if (options.imu.empty()) {
        lone_gyro_ = topics_.imu.gyro;
        return false;
      }
      throw InputError(bag_->path() +
                       ": has no inertial sensor (sensor_msgs/Imu); leave imu "
                       "(--imu) out");
    }
    try {
      imu_.emplace(bag_.get(), topics_.imu);
    } catch (const InputError& error) {
      throw InputError(error.what() +
                       std::string("; imu=none (--imu=none) leaves the sensor "
                                   "out"));
    }
    if (!imu_->frame_id().has_value()) return false;  // no messages
    ImuCalibration calibration = ChooseImuCalibration(options);
    if (!calibration.cam_from_imu.has_value()) {
      calibration.cam_from_imu =
          CamFromImu(bag_.get(), topics_, *imu_->frame_id());
    }
    imu_sensor_ = {calibration, imu_->has_gyro()};
    imu_feed_ = ImuFeed(calibration.delay_s.value_or(0.0));
    return true;
  }

  // Reads on until the inertial samples cover a frame, or until the sensor is
  // taken to have stopped.
  void ReadImuFor(double stamp) {
    constexpr double kLongestWait = 1.0;  // s, by the clock of the recorder
    const double start = received_;
    while (imu_sensor_.has_value() && !imu_feed_.Covers(stamp) &&
           received_ < start + kLongestWait && damage_ == nullptr && ReadOn()) {
    }
  }

  void AddImuRemarks(std::vector<std::string>* lines) const {
    if (!lone_gyro_.empty()) {
      lines->push_back(bag_->path() + ": " + lone_gyro_ +
                       " is not used: no topic has the accelerations of this "
                       "sensor; record its accelerometer, too");
    }
    if (!imu_sensor_.has_value()) return;
    const std::string name = bag_->path() + ": " + topics_.imu.accel;
    if (topics_.imu.had_choice) {
      lines->push_back(name +
                       " is taken for the inertial sensor; choose others with "
                       "topics");
    }
    const std::string warning = imu_->Warning();
    if (!warning.empty()) lines->push_back(name + ": " + warning);
    const std::string left_out = imu_feed_.Remark(name);
    if (!left_out.empty()) lines->push_back(left_out);
  }

  // Reads the next message. Returns false if the bag has ended before.
  bool ReadOn() {
    if (is_read_) return false;
    std::optional<BagMessage> message;
    try {
      message = messages_();
    } catch (const InputError&) {
      error_ = std::current_exception();  // rethrown after the frames before it
    }
    if (!message.has_value()) {
      is_read_ = true;
      pairing_.Finish();
      return true;
    }
    received_ = message->received;
    try {
      Add(*message);
    } catch (const InputError& error) {
      if (message->topic != topics_.color && message->topic != topics_.depth) {
        damaged_transform_ = error.what();
        return true;
      }
      damage_ = std::current_exception();
      if (num_frames_ == 0) last_stamp_ = message->received;
    }
    return true;
  }

  void Add(const BagMessage& message) {
    const bool is_color = message.topic == topics_.color;
    if (imu_sensor_.has_value() && (message.topic == topics_.imu.accel ||
                                    message.topic == topics_.imu.gyro)) {
      for (const ImuSample& sample : imu_->Add(message)) imu_feed_.Add(sample);
      return;
    }
    if (!is_color && message.topic != topics_.depth) {
      transforms_.Add(ReadMessage(*bag_, message, ReadRosTransforms));
      return;
    }
    const RosHeader header = ReadImageOf(*bag_, message).header;
    const bool has_stamp = header.stamp > 0.0;
    if (!has_stamp) ++unstamped_;
    const double stamp = has_stamp ? header.stamp : message.received;
    Stream& stream = is_color ? color_ : depth_;
    if (stream.images++ == 0) {
      stream.first = stamp;
      stream.frame = header.frame_id;
    }
    if (!is_color) {
      pairing_.AddDepth({stamp, message.bytes});
    } else if (!pairing_.AddColor({stamp, message.bytes})) {
      throw InputError(NameOf(message.topic, stamp) + ": is more than " +
                       std::to_string(ImagePairing::kWindow) +
                       " images out of order; rewrite the bag in the order of "
                       "its header stamps");
    }
  }

  RgbdFrame MakeFrame(const PairedImages<StampedImage>& pair) {
    const int index = num_frames_++;
    last_stamp_ = pair.color.timestamp;
    return {last_stamp_, [this, index, pair] {
              const std::string color_name =
                  NameOf(topics_.color, pair.color.timestamp);
              const std::string depth_name =
                  NameOf(topics_.depth, pair.depth.timestamp);
              cv::Mat color;
              const cv::Mat gray = DecodeRosGray(
                  ReadImageOf(*bag_, {topics_.color, 0.0, pair.color.message}),
                  color_name, assembly_.keep_color() ? &color : nullptr);
              const cv::Mat depth = DecodeRosDepth(
                  ReadImageOf(*bag_, {topics_.depth, 0.0, pair.depth.message}),
                  depth_name, assembly_.camera().depth_scale);
              return assembly_.Make(
                  {index, pair.color.timestamp,
                   pair.depth.timestamp - pair.color.timestamp},
                  {gray, color_name}, color, {depth, depth_name});
            }};
  }

  std::string NameOf(const std::string& topic, double stamp) const {
    return bag_->path() + ": " + topic + Format(" at %.6f s", stamp);
  }

  std::unique_ptr<BagReader> bag_;
  BagTopics topics_;
  double max_time_difference_;
  FrameAssembly assembly_;
  BagReader::Messages messages_;
  ImagePairing pairing_;
  TransformTree transforms_;
  std::optional<BagImu> imu_;
  std::optional<ImuSensor> imu_sensor_;  // nothing: its messages are not read
  std::string lone_gyro_;  // topic of a gyroscope without an accelerometer
  ImuFeed imu_feed_;
  double received_ = 0.0;  // the recorder's time of the last message, s
  Stream color_;
  Stream depth_;
  int unstamped_ = 0;  // images whose time is that of recording
  int num_frames_ = 0;
  // The error of the last damaged message that is no image.
  std::string damaged_transform_;
  double last_stamp_ = 0.0;    // of the last frame, s
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
