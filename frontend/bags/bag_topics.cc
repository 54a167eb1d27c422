#include "frontend/bags/bag_topics.h"

#include <algorithm>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/bags/ros_image.h"

namespace rgbd_pose {
namespace {

constexpr char kImage[] = "sensor_msgs/Image";
constexpr char kCompressedImage[] = "sensor_msgs/CompressedImage";
constexpr char kCameraInfo[] = "sensor_msgs/CameraInfo";

bool IsImage(const BagTopic& topic) {
  return topic.type == kImage || topic.type == kCompressedImage;
}

std::string Parent(const std::string& topic) {
  return topic.substr(0, topic.rfind('/'));
}

// The list of topics for an error message.
std::string ListOf(const std::vector<BagTopic>& topics) {
  constexpr size_t kMaxNames = 12;
  std::vector<std::string> names;
  for (const BagTopic& topic : topics) {
    if (IsImage(topic)) names.push_back(topic.name);
  }
  if (names.empty()) {
    for (const BagTopic& topic : topics) {
      names.push_back(topic.name + " (" + topic.type + ")");
    }
  }
  if (names.empty()) return "none";
  const bool is_long = names.size() > kMaxNames;
  if (is_long) names.resize(kMaxNames);
  return Join(names) + (is_long ? ", ..." : "");
}

// How suitable an image topic is as colour or depth; 0: unsuitable.
struct Fitness {
  std::string topic;
  int color = 0;
  int depth = 0;
  std::string encoding = {};  // of its images
};

// Whether the name of a topic says that its 16-bit or floating-point images are
// not depth. Depth that is aligned to an infrared camera is called depth, too.
bool IsCalledOtherThanDepth(const std::string& name) {
  for (const char* word : {"disparity", "confidence"}) {
    if (Contains(name, word)) return true;
  }
  if (Contains(name, "depth")) return false;
  for (const char* word : {"infra", "/ir", "thermal", "lwir"}) {
    if (Contains(name, word)) return true;
  }
  return false;
}

Fitness FitnessOf(BagReader* bag, const BagTopic& topic) {
  Fitness fitness{topic.name};
  const std::vector<BagMessage> first = bag->First(topic.name, 1);
  if (first.empty()) return fitness;
  const RosImage image = ReadImageOf(*bag, first.front());
  const std::string name = cv::toLowerCase(topic.name);
  const int if_raw = topic.type == kImage ? 1 : 0;
  fitness.encoding = image.encoding;
  RosImageUse use = UseOfEncoding(fitness.encoding);
  // The format of a compressed PNG image does not say that it is depth.
  const bool may_be_depth = use == RosImageUse::kGrayOrDepth ||
                            (use == RosImageUse::kColor && if_raw == 0);
  if (may_be_depth && Contains(name, "depth")) use = RosImageUse::kDepth;
  if (use == RosImageUse::kColor) {
    fitness.color = 40 + if_raw;
  } else if (use == RosImageUse::kRawColor) {
    fitness.color = 30 + if_raw;
  } else if (use == RosImageUse::kGray) {
    const bool is_infrared = Contains(name, "infra") || Contains(name, "/ir");
    fitness.color = (is_infrared ? 10 : 20) + if_raw;
  } else if (use != RosImageUse::kOther && !IsCalledOtherThanDepth(name)) {
    const bool is_named = Contains(name, "depth");
    fitness.depth = (IsCalledRegistered(name) ? 40
                     : is_named               ? 20
                                              : 5) +
                    if_raw;
  }
  return fitness;
}

// Whether two topics show the same image, at the first stamp that both have:
// drivers publish one image under several names, or depth in mm and in metres.
bool AreSame(BagReader* bag, const std::string& a, const std::string& b,
             bool is_depth) {
  constexpr int kImages = 8;
  constexpr double kMaxShare = 0.02;  // of pixels that differ
  const auto decode = [&](const BagMessage& message) {
    const RosImage image = ReadImageOf(*bag, message);
    return is_depth ? DecodeRosDepth(image, message.topic, 1000.0)
                    : DecodeRosGray(image, message.topic, nullptr);
  };
  const std::vector<BagMessage> others = bag->First(b, kImages);
  for (const BagMessage& first : bag->First(a, kImages)) {
    const double stamp = ReadImageOf(*bag, first).header.stamp;
    for (const BagMessage& other : others) {
      if (ReadImageOf(*bag, other).header.stamp != stamp) continue;
      const cv::Mat image = decode(first), same = decode(other);
      if (image.size() != same.size()) return false;
      // Metres are rounded to mm, and missing depth is 0, 65535 or NaN.
      cv::Mat difference;
      cv::absdiff(image, same, difference);
      const int differ = cv::countNonZero(difference > (is_depth ? 1 : 0));
      return differ <= kMaxShare * static_cast<double>(image.total());
    }
  }
  return false;
}

// The topic most suitable as `what`. Sets `had_choice` if others are suitable.
std::string Best(BagReader* reader, const std::vector<Fitness>& fitness,
                 int Fitness::*what, const char* name, bool* had_choice) {
  const BagReader& bag = *reader;
  int most = 1;
  for (const Fitness& f : fitness) most = std::max(most, f.*what);
  std::vector<std::string> best;  // all that are equally suitable
  std::vector<std::string> encodings;
  for (const Fitness& f : fitness) {
    if (f.*what == most) best.push_back(f.topic);
    if (f.*what > 0 && f.*what < most) *had_choice = true;
    encodings.push_back(f.topic + " '" + f.encoding + "'");
  }
  if (best.empty()) {
    throw InputError(
        bag.path() + ": has no readable " + name +
        " images; topics: " + ListOf(bag.topics()) +
        (encodings.empty() ? "" : " (encodings: " + Join(encodings) + ")"));
  }
  for (size_t i = 1; i < best.size(); ++i) {
    *had_choice = true;
    if (AreSame(reader, best[0], best[i], what == &Fitness::depth)) continue;
    throw InputError(bag.path() + ": both " + best.front() + " and " + best[i] +
                     " may be the " + name +
                     " images; choose with topics=COLOUR,DEPTH from " +
                     ListOf(bag.topics()));
  }
  return best.front();
}

// The CameraInfo topic of an image topic: next to it, or where the RealSense
// viewer records it. Empty if there is none.
std::string InfoOf(const BagReader& bag, const std::string& image) {
  std::string parent = Parent(image);
  std::vector<std::string> candidates;
  // A compressed topic is one level below the topic of the raw images.
  if (bag.FindTopic(image)->type == kCompressedImage) {
    candidates.push_back(parent + "/camera_info");
    parent = Parent(parent);
  }
  candidates.push_back(parent + "/camera_info");
  candidates.push_back(Parent(parent) + "/info/camera_info");
  for (const std::string& info : candidates) {
    const BagTopic* topic = bag.FindTopic(info);
    if (topic != nullptr && topic->type == kCameraInfo) return info;
  }
  return "";
}

// The name, if the bag has such a topic of images or of CameraInfo.
std::string Existing(const BagReader& bag, const std::string& name,
                     bool is_image) {
  const BagTopic* topic = bag.FindTopic(name);
  if (topic != nullptr &&
      (is_image ? IsImage(*topic) : topic->type == kCameraInfo)) {
    return name;
  }
  const std::string has = topic == nullptr
                              ? "no topic '" + name + "'"
                              : name + " of the unsuitable type " + topic->type;
  throw InputError(bag.path() + ": has " + has +
                   "; topics: " + ListOf(bag.topics()));
}

}  // namespace

bool IsCalledRegistered(const std::string& topic) {
  const std::string name = cv::toLowerCase(topic);
  return Contains(name, "regist") || Contains(name, "align") ||
         Contains(name, "depth_to_color") || Contains(name, "depth_to_rgb");
}

RosImage ReadImageOf(const BagReader& bag, const BagMessage& message) {
  const bool is_raw = bag.FindTopic(message.topic)->type == kImage;
  return ReadMessage(bag, message,
                     is_raw ? ReadRosImage : ReadRosCompressedImage);
}

BagTopics ChooseTopics(BagReader* bag,
                       const std::vector<std::string>& all_names) {
  BagTopics chosen;
  std::vector<std::string> names, of_imu;
  for (const std::string& name : all_names) {
    (IsImuTopic(*bag, name) ? of_imu : names).push_back(name);
  }
  if (names.empty()) {
    std::vector<Fitness> fitness;
    for (const BagTopic& topic : bag->topics()) {
      if (IsImage(topic)) fitness.push_back(FitnessOf(bag, topic));
    }
    chosen.color =
        Best(bag, fitness, &Fitness::color, "colour", &chosen.had_choice);
    chosen.depth =
        Best(bag, fitness, &Fitness::depth, "depth", &chosen.had_choice);
    // Some drivers call depth otherwise: users are told what was taken for it.
    if (!Contains(cv::toLowerCase(chosen.depth), "depth")) {
      chosen.had_choice = true;
    }
  } else {
    if (names.size() < 2 || names.size() > 3) {
      throw InputError(
          "topics: must be COLOUR,DEPTH or COLOUR,DEPTH,CAMERA_INFO, not " +
          std::to_string(names.size()) + " names");
    }
    chosen.color = Existing(*bag, names[0], true);
    chosen.depth = Existing(*bag, names[1], true);
  }
  chosen.color_info = names.size() == 3 ? Existing(*bag, names[2], false)
                                        : InfoOf(*bag, chosen.color);
  chosen.depth_info = InfoOf(*bag, chosen.depth);
  for (const BagTopic& topic : bag->topics()) {
    if (topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage") {
      chosen.transforms.push_back(topic.name);
    }
  }
  chosen.imu = ChooseImuTopics(*bag, of_imu, chosen.color);
  return chosen;
}

}  // namespace rgbd_pose
