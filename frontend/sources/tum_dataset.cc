#include <algorithm>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/image_file.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/image_pairing.h"
#include "frontend/sources/masks.h"
#include "frontend/sources/open_source.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kAssociations[] = "associations.txt";

struct ListedImage {
  double timestamp;
  std::string path;
  int line;  // line number in its list
};

struct TumLists {
  std::vector<PairedImages<ListedImage>> pairs;  // by time; never empty
  int unmatched_color = 0;  // colour images without a depth image
  int same_stamp = 0;       // images left out for having the stamp of another
};

std::string Quote(const TextLine& line) {
  constexpr size_t kMaxLength = 120;
  std::string text = Join(line.words, " ");
  if (text.size() > kMaxLength) text = text.substr(0, kMaxLength) + "...";
  return "'" + text + "'";
}

// The image in two columns of a list: its time and its path.
ListedImage ImageIn(const TextLine& line, size_t column,
                    const std::string& list, const std::string& folder) {
  return {ParseTimestamp(line.words[column], list, line.number),
          (fs::path(folder) / line.words[column + 1]).string(), line.number};
}

std::vector<TextLine> ReadLines(const std::string& list, size_t columns,
                                const std::string& wanted) {
  std::vector<TextLine> lines = ReadTextTable(list);
  if (lines.empty()) throw InputError(list + ": lists no images");
  for (const TextLine& line : lines) {
    if (line.words.size() != columns) {
      throw InputError(list, line.number,
                       "needs " + std::to_string(columns) + " columns (" +
                           wanted + "), has " +
                           std::to_string(line.words.size()) +
                           (line.words.size() > columns
                                ? "; names of images must not have spaces: "
                                : ": ") +
                           Quote(line));
    }
  }
  return lines;
}

// Whether the times are rather those from one image to the next: short, and as
// often smaller as larger than the one before.
bool AreIntervals(const std::vector<ListedImage>& images) {
  constexpr double kLongest = 1.0;  // s
  size_t smaller = 0;
  for (size_t i = 0; i < images.size(); ++i) {
    if (images[i].timestamp > kLongest) return false;
    smaller += i > 0 && images[i].timestamp <= images[i - 1].timestamp;
  }
  return 3 * smaller > images.size();
}

void CheckTimeOrder(const std::string& list,
                    const std::vector<ListedImage>& images) {
  for (size_t i = 1; i < images.size(); ++i) {
    if (images[i].timestamp >= images[i - 1].timestamp) continue;
    throw InputError(list, images[i].line,
                     AreIntervals(images)
                         ? "the times look like intervals between images; add "
                           "them up to time stamps"
                         : "the time stamp is earlier than the previous one; "
                           "sort the list");
  }
}

std::vector<ListedImage> ReadImageList(const std::string& folder,
                                       const std::string& name,
                                       int* same_stamp) {
  const std::string list = (fs::path(folder) / name).string();
  if (!PathExists(list)) {
    throw InputError(list +
                     ": missing; a TUM RGB-D sequence has rgb.txt and "
                     "depth.txt, or else give an associations file");
  }
  std::vector<ListedImage> images;
  for (const TextLine& line : ReadLines(list, 2, "time image")) {
    images.push_back(ImageIn(line, 0, list, folder));
  }
  CheckTimeOrder(list, images);
  const auto end = std::unique(images.begin(), images.end(),
                               [](const ListedImage& a, const ListedImage& b) {
                                 return a.timestamp == b.timestamp;
                               });
  *same_stamp += static_cast<int>(images.end() - end);
  images.erase(end, images.end());
  return images;
}

bool MentionsDepth(const std::string& path) {
  return cv::toLowerCase(path).find("depth") != std::string::npos;
}

bool IsDepthImage(const ListedImage& image) {
  return ReadImageFile(image.path).type() == CV_16UC1;
}

// Whether an associations file has the depth images in its left columns: by the
// paths in its first line, or else by the images themselves.
bool IsDepthLeft(const std::string& list, const TextLine& line,
                 const ListedImage& left, const ListedImage& right) {
  const bool is_named = MentionsDepth(line.words[1]);
  if (is_named != MentionsDepth(line.words[3])) return is_named;
  const bool is_depth = IsDepthImage(left);
  if (is_depth != IsDepthImage(right)) return is_depth;
  throw InputError(list, line.number,
                   "one image of a line must be colour and one depth (16 "
                   "bits, 1 channel): " +
                       Quote(line));
}

// Pairs rgb.txt and depth.txt by nearest time.
TumLists ReadTumLists(const std::string& folder, double max_time_difference) {
  TumLists lists;
  const std::vector<ListedImage> color =
      ReadImageList(folder, "rgb.txt", &lists.same_stamp);
  const std::vector<ListedImage> depth =
      ReadImageList(folder, "depth.txt", &lists.same_stamp);
  for (const auto& [i, j] :
       Associate(TimesOf(color), TimesOf(depth), max_time_difference)) {
    lists.pairs.push_back({color[i], depth[j]});
  }
  if (lists.pairs.empty()) {
    throw InputError(folder +
                     Format(": no image of rgb.txt is within %f s of one of "
                            "depth.txt; the lists start at %f and %f s",
                            max_time_difference, color.front().timestamp,
                            depth.front().timestamp));
  }
  lists.unmatched_color = static_cast<int>(color.size() - lists.pairs.size());
  return lists;
}

// Pairs from lines `time colour_image time depth_image`, or depth first.
TumLists ReadTumAssociations(const std::string& folder,
                             const std::string& list) {
  const std::vector<TextLine> lines =
      ReadLines(list, 4, "time image time image");
  std::vector<ListedImage> color;
  std::vector<ListedImage> depth;
  for (const TextLine& line : lines) {
    color.push_back(ImageIn(line, 0, list, folder));
    depth.push_back(ImageIn(line, 2, list, folder));
  }
  if (IsDepthLeft(list, lines.front(), color.front(), depth.front())) {
    color.swap(depth);
  }
  CheckTimeOrder(list, color);
  TumLists lists;
  for (size_t i = 0; i < color.size(); ++i) {
    if (i > 0 && color[i].timestamp == color[i - 1].timestamp) {
      ++lists.same_stamp;
    } else {
      lists.pairs.push_back({color[i], depth[i]});
    }
  }
  return lists;
}

// The file that pairs the images: given, or in a folder without lists.
std::string AssociationsOf(const SourceOptions& options) {
  if (!options.associations_file.empty()) return options.associations_file;
  const fs::path folder = options.path;
  const bool has_lists =
      PathExists(folder / "rgb.txt") || PathExists(folder / "depth.txt");
  const fs::path own = folder / kAssociations;
  return !has_lists && PathExists(own) ? own.string() : "";
}

TumLists ReadLists(const SourceOptions& options) {
  RequireSound(options.Check());
  std::error_code error;
  if (!fs::is_directory(options.path, error)) {
    throw InputError(options.path +
                     ": no such folder; give the folder of a TUM RGB-D "
                     "sequence");
  }
  const std::string associations = AssociationsOf(options);
  return associations.empty()
             ? ReadTumLists(options.path, options.max_time_difference)
             : ReadTumAssociations(options.path, associations);
}

// ICL-NUIM's releases in TUM's layout: times are the numbers of the images.
bool IsIclNuim(const SourceOptions& options, const TumLists& lists) {
  return options.associations_file.empty() &&
         !AssociationsOf(options).empty() &&
         std::all_of(lists.pairs.begin(), lists.pairs.end(),
                     [](const PairedImages<ListedImage>& pair) {
                       const auto number = ParseWhole(
                           fs::path(pair.color.path).stem().string());
                       return number == pair.color.timestamp;
                     });
}

// The camera of ICL-NUIM's renderer, as its page states it: fy = -480.
CameraSetup IclNuimCamera() {
  CameraSetup setup(Camera{640, 480, 481.2, 480.0, 319.5, 239.5});
  setup.is_upside_down = true;
  return setup;
}

// The true path of a folder: groundtruth.txt, or ICL-NUIM's *.gt.freiburg.
fs::path TruthFile(const fs::path& folder) {
  std::error_code error;
  if (PathExists(folder / "groundtruth.txt")) return folder / "groundtruth.txt";
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path& path = entry.path();
    const bool is_truth =
        path.extension() == ".freiburg" && path.stem().extension() == ".gt";
    if (is_truth) return path;
  }
  return {};
}

// The same path in a world whose y axis is inverted.
Trajectory Mirrored(Trajectory path) {
  // M T M with M = diag(1, -1, 1) has a proper rotation again.
  for (StampedPose& pose : path) {
    const Eigen::Quaterniond q = pose.world_from_cam.rotation;
    const Eigen::Vector3d t = pose.world_from_cam.translation;
    pose.world_from_cam =
        Rigid3d(Eigen::Quaterniond(q.w(), -q.x(), q.y(), -q.z()),
                {t.x(), -t.y(), t.z()});
  }
  return path;
}

// The image size is taken from an image, since the file does not contain it.
CameraSetup ReadCalibrationText(const std::string& path,
                                const std::string& first_image) {
  const std::vector<TextLine> lines = ReadTextTable(path);
  if (lines.empty() || lines.front().words.size() != 4) {
    throw InputError(path +
                     ": needs one line, fx fy cx cy; for a lens with "
                     "distortion give a camera file (--camera)");
  }
  double numbers[4];
  for (int i = 0; i < 4; ++i) {
    numbers[i] = ParseNumber(lines.front().words[i], path, lines.front().number,
                             "fx fy cx cy");
  }
  const cv::Mat image = ReadGrayImageFile(first_image);
  const Camera camera = {image.cols, image.rows, numbers[0],
                         numbers[1], numbers[2], numbers[3]};
  RequireSound(camera.Check(), path + ": ");
  return CameraSetup(camera);
}

std::optional<CameraSetup> OwnCamera(const SourceOptions& options,
                                     const TumLists& lists, bool is_icl_nuim,
                                     std::string* remark) {
  if (options.camera.has_value()) return std::nullopt;  // not needed
  const fs::path folder = options.path;
  if (PathExists(folder / "camera.yaml")) {
    CameraSetup setup = ReadCameraFile((folder / "camera.yaml").string());
    *remark = setup.remark;
    return setup;
  }
  if (PathExists(folder / "calibration.txt")) {
    return ReadCalibrationText((folder / "calibration.txt").string(),
                               lists.pairs.front().color.path);
  }
  if (!is_icl_nuim) return std::nullopt;
  *remark = options.path +
            ": has no calibration; as times are the numbers of the images, the "
            "camera of ICL-NUIM is taken (fx 481.2, fy -480)";
  return IclNuimCamera();
}

class TumDataset final : public Dataset {
 public:
  explicit TumDataset(const SourceOptions& options)
      : folder_(options.path),
        lists_(ReadLists(options)),
        is_icl_nuim_(IsIclNuim(options, lists_)),
        assembly_(ChooseCamera(options, OwnCamera(options, lists_, is_icl_nuim_,
                                                  &camera_remark_)),
                  options.keep_color) {}

  int size() const override { return static_cast<int>(lists_.pairs.size()); }
  double timestamp(int index) const override {
    return lists_.pairs[index].color.timestamp;
  }
  Frame Read(int index) const override {
    const auto& [color, depth] = lists_.pairs[index];
    return assembly_.Read(
        {index, color.timestamp, depth.timestamp - color.timestamp}, color.path,
        depth.path);
  }
  const RgbdCamera& camera() const override { return assembly_.camera(); }
  int unmatched_color() const override { return lists_.unmatched_color; }

  Trajectory ground_truth() const override {
    const fs::path path = TruthFile(folder_);
    if (path.empty()) return {};
    truth_remarks_.clear();
    Trajectory truth = ReadTrajectory(path.string(), &truth_remarks_);
    // ICL-NUIM's world fits only its own camera.
    const bool fits = !is_icl_nuim_ || assembly_.is_upside_down();
    return fits ? truth : Mirrored(std::move(truth));
  }

  std::vector<std::string> remarks() const override {
    std::vector<std::string> lines = truth_remarks_;
    if (!camera_remark_.empty()) lines.push_back(camera_remark_);
    if (lists_.same_stamp > 0) {
      lines.push_back(SameStampRemark(folder_, lists_.same_stamp));
    }
    std::vector<std::string> colors;
    for (const auto& pair : lists_.pairs) colors.push_back(pair.color.path);
    for (const std::string& line :
         {IntervalRemark(folder_, timestamps()), MaskRemark(colors)}) {
      if (!line.empty()) lines.push_back(line);
    }
    return lines;
  }

 private:
  std::string folder_;
  TumLists lists_;
  bool is_icl_nuim_;
  std::string camera_remark_;
  mutable std::vector<std::string> truth_remarks_;
  FrameAssembly assembly_;
};

}  // namespace

std::unique_ptr<Dataset> OpenTum(const SourceOptions& options) {
  return std::make_unique<TumDataset>(options);
}

}  // namespace rgbd_pose
