#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "core/util/text_hash.h"
#include "frontend/slam/map_folder.h"

namespace rgbd_pose {
namespace {

constexpr std::string_view kMagic = "rgbd_pose_map ";
constexpr std::string_view kVersion = "1";
constexpr char kColumns[] =
    "# camera width height fx fy cx cy k1 k2 p1 p2 k3 (k4 k5 k6 lens)\n"
    "# keyframe id segment timestamp depth_delay depth_scale tx ty tz qx qy "
    "qz qw gray depth (timing_covariance (6 x 6))\n"
    "# edge ref cur tx ty tz qx qy qz qw covariance (6 x 6) (tracked)\n"
    "# up keyframe x y z sigma\n";

constexpr char kTracked[] = "tracked";  // the last word of such an edge

// Names of lens models.
constexpr char kRational[] = "rational";
constexpr char kEquidistant[] = "equidistant";

using Image = std::shared_ptr<const PngBytes>;

struct LineWriter {
  std::string text;  // starts with the kind of the line

  void Word(const std::string& word) { text += ' ' + word; }
  void Integer(const int* value) { Word(std::to_string(*value)); }
  void Number(const double* value) { Word(ShortNumber(*value)); }
  void ImageName(const Image* image) { Word((*image)->checksum); }
};

// Reads the words of a line one after the other.
struct LineReader {
  const TextLine& line;
  const std::string& path;
  size_t next = 1;

  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(path, line.number, what);
  }
  void Require(size_t words) const {
    if (line.words.size() == words) return;
    Fail("a line '" + Kind() + "' must have " + std::to_string(words) +
         " words, this one has " + std::to_string(line.words.size()));
  }
  const std::string& Kind() const { return line.words[0]; }
  size_t Count() const { return line.words.size(); }
  const std::string& Word() { return line.words[next++]; }
  void Number(double* value) {
    *value = ParseNumber(Word(), path, line.number, "a " + Kind());
  }
  void Integer(int* integer) {
    double value = 0.0;
    Number(&value);
    constexpr double kMin = std::numeric_limits<int>::min();
    constexpr double kMax = std::numeric_limits<int>::max();
    if (value != std::floor(value) || value < kMin || value > kMax) {
      Fail("'" + line.words[next - 1] + "' must be an integer");
    }
    *integer = static_cast<int>(value);
  }
  void ImageName(Image* image) {
    const std::string& name = Word();
    if (!IsImageName(name)) Fail("'" + name + "' must be an image's checksum");
    *image = std::make_shared<const PngBytes>("", name);
  }
};

// The words of each line in their order, for a LineWriter or a LineReader.

// Does not use the constructor of Rigid3d, which might change the last digit.
template <typename Line, typename Rigid>
void PassMotion(Line* line, Rigid* motion) {
  for (int i = 0; i < 3; ++i) line->Number(&motion->translation[i]);
  for (int i = 0; i < 4; ++i) line->Number(&motion->rotation.coeffs()[i]);
}

template <typename Line, typename Matrix>
void PassCovariance(Line* line, Matrix* covariance) {
  for (int i = 0; i < 36; ++i) line->Number(&(*covariance)(i / 6, i % 6));
}

template <typename Line, typename Node>
void PassKeyframe(Line* line, Node* keyframe) {
  line->Integer(&keyframe->id);
  line->Integer(&keyframe->segment);
  line->Number(&keyframe->images.timestamp);
  line->Number(&keyframe->images.depth_delay);
  line->Number(&keyframe->images.depth_scale);
  PassMotion(line, &keyframe->world_from_cam);
  line->ImageName(&keyframe->images.gray);
  line->ImageName(&keyframe->images.depth);
}

template <typename Line, typename Edge>
void PassEdge(Line* line, Edge* edge) {
  line->Integer(&edge->ref);
  line->Integer(&edge->cur);
  PassMotion(line, &edge->cur_from_ref);
  PassCovariance(line, &edge->covariance);
}

template <typename Line, typename Direction>
void PassUp(Line* line, Direction* up) {
  line->Integer(&up->keyframe);
  for (int i = 0; i < 3; ++i) line->Number(&up->in_cam[i]);
  line->Number(&up->sigma);
}

void ReadCamera(LineReader* line, Camera* camera) {
  const bool is_usual = line->Count() <= 3 + kNumUsualParameters;
  const size_t count =
      is_usual ? kNumUsualParameters : kCameraParameters.size();
  line->Require(3 + count + (is_usual ? 0 : 1));
  line->Integer(&camera->width);
  line->Integer(&camera->height);
  for (size_t i = 0; i < count; ++i) {
    line->Number(&(camera->*kCameraParameters[i].value));
  }
  if (is_usual) return;
  const std::string& lens = line->Word();
  if (lens != kRational && lens != kEquidistant) {
    line->Fail("lens '" + lens + "' must be 'rational' or 'equidistant'");
  }
  if (lens == kEquidistant) camera->lens_model = LensModel::kEquidistant;
}

std::string FormatCamera(const Camera& camera) {
  LineWriter line = {"camera"};
  line.Integer(&camera.width);
  line.Integer(&camera.height);
  // The long form is used if the short one cannot express the lens.
  const bool is_equidistant = camera.lens_model == LensModel::kEquidistant;
  const bool is_usual = !is_equidistant && camera.MakeLens().factor !=
                                               Lens<double>::Factor::kRational;
  for (size_t i = 0; i < kCameraParameters.size(); ++i) {
    if (is_usual && i == kNumUsualParameters) break;
    line.Number(&(camera.*kCameraParameters[i].value));
  }
  if (!is_usual) line.Word(is_equidistant ? kEquidistant : kRational);
  return line.text + '\n';
}

// Checks the first and the last line of a text and returns it without the last.
std::string_view Unseal(std::string_view text, const std::string& path) {
  RequireIndexFormat(text, path);
  const size_t last = text.rfind('\n', text.size() - 2) + 1;
  if (text.substr(last) != ChecksumLine(text.substr(0, last))) {
    throw InputError(path +
                     ": is damaged or edited (wrong checksum); restore a copy "
                     "of the map or create it again");
  }
  return text.substr(0, last);
}

}  // namespace

std::string ChecksumLine(std::string_view above) {
  return "checksum " + TextHash().Add(above).Hex() + "\n";
}

bool IsImageName(std::string_view word) {
  return word.size() == 16 &&
         word.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

void RequireIndexFormat(std::string_view text, const std::string& path) {
  if (text.substr(0, kMagic.size()) != kMagic) {
    throw InputError(path +
                     ": is not a map of rgbd_slam; choose another folder");
  }
  const size_t line_end = std::min(text.find('\n'), text.size());
  std::string_view version =
      text.substr(kMagic.size(), line_end - kMagic.size());
  // Windows line ends are an edit, which the checksum shows.
  if (!version.empty() && version.back() == '\r') version.remove_suffix(1);
  if (version != kVersion) {
    constexpr size_t kShown = 20;  // the line of a damaged file may not end
    throw InputError(path + ": has format version " +
                     std::string(version.substr(0, kShown)) +
                     ", this program reads version " + std::string(kVersion) +
                     " only; use a newer program");
  }
}

std::string FormatMapIndex(const KeyframeMap& map) {
  std::string text;
  ((text += kMagic) += kVersion) += '\n';
  text += kColumns + FormatCamera(map.camera);
  for (const Keyframe& keyframe : map.keyframes) {
    LineWriter line = {"keyframe"};
    PassKeyframe(&line, &keyframe);
    PassCovariance(&line, &keyframe.timing_covariance);
    text += line.text + '\n';
  }
  for (const MapEdge& edge : map.edges) {
    LineWriter line = {"edge"};
    PassEdge(&line, &edge);
    if (edge.is_tracked) line.Word(kTracked);
    text += line.text + '\n';
  }
  for (const MapUp& up : map.ups) {
    LineWriter line = {"up"};
    PassUp(&line, &up);
    text += line.text + '\n';
  }
  return text + ChecksumLine(text);
}

KeyframeMap ParseMapIndex(std::string_view text, const std::string& path) {
  const std::vector<TextLine> lines = SplitTextTable(Unseal(text, path));
  KeyframeMap map;
  for (size_t i = 1; i < lines.size(); ++i) {
    LineReader line = {lines[i], path};
    if ((i == 1) != (line.Kind() == "camera")) {
      line.Fail("there must be one camera line, before all others");
    }
    if (line.Kind() == "camera") {
      ReadCamera(&line, &map.camera);
    } else if (line.Kind() == "keyframe") {
      // Maps of earlier versions lack the last words of both.
      if (line.Count() != 15) line.Require(15 + 36);
      Keyframe& keyframe = map.keyframes.emplace_back();
      PassKeyframe(&line, &keyframe);
      if (line.Count() > 15) PassCovariance(&line, &keyframe.timing_covariance);
    } else if (line.Kind() == "edge") {
      MapEdge& edge = map.edges.emplace_back();
      edge.is_tracked = line.line.words.back() == kTracked;
      line.Require(edge.is_tracked ? 47 : 46);
      PassEdge(&line, &edge);
    } else if (line.Kind() == "up") {
      line.Require(6);
      PassUp(&line, &map.ups.emplace_back());
    } else {
      line.Fail("'" + line.Kind() + "' must be camera, keyframe, edge or up");
    }
  }
  if (lines.size() < 2) throw InputError(path + ": has no camera");
  return map;
}

}  // namespace rgbd_pose
