#include "frontend/bags/bag_topics.h"

#include <algorithm>
#include <cctype>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

constexpr char kImage[] = "sensor_msgs/Image";
constexpr char kCompressedImage[] = "sensor_msgs/CompressedImage";
constexpr char kCameraInfo[] = "sensor_msgs/CameraInfo";

bool IsImage(const BagTopic& topic) {
  return topic.type == kImage || topic.type == kCompressedImage;
}

std::string LowerCase(std::string text) {
  for (char& c : text) {
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
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

// How suitable a topic is as colour or depth; 0: unsuitable.
struct Fitness {
  int color = 0;
  int depth = 0;
  std::string encoding;  // of its images
};

Fitness FitnessOf(BagReader* bag, int index) {
  const BagTopic& topic = bag->topics()[index];
  const std::vector<BagMessage> first = bag->First(index, 1);
  if (first.empty()) return {};
  const RosImage image = ReadImageOf(*bag, first.front());
  const std::string name = LowerCase(topic.name);
  const bool is_raw = topic.type == kImage;
  const bool is_called_depth = Contains(name, "depth");
  RosImageUse use = UseOfEncoding(std::string(image.encoding));
  if (use == RosImageUse::kGrayOrDepth && is_called_depth) {
    use = RosImageUse::kDepth;
  }
  // The format of a compressed PNG image does not say that it is depth.
  if (use == RosImageUse::kColor && !is_raw && is_called_depth) {
    use = RosImageUse::kDepth;
  }
  Fitness fitness;
  fitness.encoding = image.encoding;
  switch (use) {
    case RosImageUse::kColor:
      fitness.color = 40;
      break;
    case RosImageUse::kGray:
      fitness.color =
          Contains(name, "infra") || Contains(name, "/ir") ? 10 : 20;
      break;
    case RosImageUse::kDepth:
    case RosImageUse::kMetricDepth: {
      fitness.depth = IsCalledRegistered(topic.name) ? 40 : 20;
      break;
    }
    case RosImageUse::kGrayOrDepth:
      fitness.depth = 5;
      break;
    case RosImageUse::kOther:
      break;
  }
  if (fitness.color > 0) fitness.color += is_raw ? 1 : 0;
  if (fitness.depth > 0) fitness.depth += is_raw ? 1 : 0;
  return fitness;
}

int Best(const BagReader& bag, const std::vector<Fitness>& fitness,
         int Fitness::*what, const char* name) {
  int best = -1;
  int rival = -1;
  for (size_t i = 0; i < fitness.size(); ++i) {
    if (fitness[i].*what == 0) continue;
    if (best < 0 || fitness[i].*what > fitness[best].*what) {
      best = static_cast<int>(i);
      rival = -1;
    } else if (fitness[i].*what == fitness[best].*what) {
      rival = static_cast<int>(i);
    }
  }
  const std::vector<BagTopic>& topics = bag.topics();
  if (best < 0) {
    std::string encodings;
    for (size_t i = 0; i < fitness.size(); ++i) {
      if (!IsImage(topics[i])) continue;
      encodings += (encodings.empty() ? " (encodings: " : ", ") +
                   topics[i].name + " '" + fitness[i].encoding + "'";
    }
    if (!encodings.empty()) encodings += ")";
    throw InputError(bag.path() + ": has no readable " + name +
                     " images; topics: " + ListOf(topics) + encodings);
  }
  if (rival >= 0) {
    throw InputError(bag.path() + ": both " + topics[best].name + " and " +
                     topics[rival].name + " may be the " + name +
                     " images; choose with topics=COLOUR,DEPTH from " +
                     ListOf(topics));
  }
  return best;
}

// The CameraInfo topic of an image topic: next to it, or where the RealSense
// viewer records it. -1 if there is none.
int InfoOf(const BagReader& bag, int image) {
  const std::vector<BagTopic>& topics = bag.topics();
  std::string name = topics[image].name;
  // A compressed topic is one level below the topic of the raw images.
  if (topics[image].type == kCompressedImage) {
    const int info = bag.FindTopic(Parent(name) + "/camera_info");
    if (info >= 0) return info;
    name = Parent(name);
  }
  for (const std::string& candidate :
       {Parent(name) + "/camera_info",
        Parent(Parent(name)) + "/info/camera_info"}) {
    const int info = bag.FindTopic(candidate);
    if (info >= 0 && topics[info].type == kCameraInfo) return info;
  }
  return -1;
}

int TopicNamed(const BagReader& bag, const std::string& name, bool is_image) {
  const std::vector<BagTopic>& topics = bag.topics();
  const int index = bag.FindTopic(name);
  if (index >= 0 &&
      (is_image ? IsImage(topics[index]) : topics[index].type == kCameraInfo)) {
    return index;
  }
  const std::string has =
      index < 0 ? "no topic '" + name + "'"
                : name + " of the unsuitable type " + topics[index].type;
  throw InputError(bag.path() + ": has " + has + "; topics: " + ListOf(topics));
}

}  // namespace

bool IsCalledRegistered(const std::string& topic) {
  const std::string name = LowerCase(topic);
  return Contains(name, "regist") || Contains(name, "align") ||
         Contains(name, "depth_to_color") || Contains(name, "depth_to_rgb");
}

RosImage ReadImageOf(const BagReader& bag, const BagMessage& message) {
  const bool is_raw = bag.topics()[message.topic].type == kImage;
  return ReadMessage(bag, message,
                     is_raw ? ReadRosImage : ReadRosCompressedImage);
}

BagTopics ChooseTopics(BagReader* bag, const std::vector<std::string>& names) {
  const std::vector<BagTopic>& topics = bag->topics();
  BagTopics chosen;
  if (names.empty()) {
    std::vector<Fitness> fitness(topics.size());
    for (size_t i = 0; i < topics.size(); ++i) {
      if (IsImage(topics[i])) fitness[i] = FitnessOf(bag, static_cast<int>(i));
    }
    chosen.color = Best(*bag, fitness, &Fitness::color, "colour");
    chosen.depth = Best(*bag, fitness, &Fitness::depth, "depth");
    for (int Fitness::*what : {&Fitness::color, &Fitness::depth}) {
      chosen.had_choice |=
          std::count_if(fitness.begin(), fitness.end(),
                        [what](const Fitness& f) { return f.*what > 0; }) > 1;
    }
  } else {
    if (names.size() < 2 || names.size() > 3) {
      throw InputError(
          "topics: must be COLOUR,DEPTH or COLOUR,DEPTH,CAMERA_INFO, not " +
          std::to_string(names.size()) + " names");
    }
    chosen.color = TopicNamed(*bag, names[0], true);
    chosen.depth = TopicNamed(*bag, names[1], true);
  }
  chosen.color_info = names.size() == 3 ? TopicNamed(*bag, names[2], false)
                                        : InfoOf(*bag, chosen.color);
  chosen.depth_info = InfoOf(*bag, chosen.depth);
  for (size_t i = 0; i < topics.size(); ++i) {
    if (topics[i].type == "tf2_msgs/TFMessage" ||
        topics[i].type == "tf/tfMessage") {
      chosen.transforms.push_back(static_cast<int>(i));
    }
  }
  return chosen;
}

}  // namespace rgbd_pose
