#include "frontend/map/map_index.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "core/util/text_hash.h"

namespace rgbd_pose {
namespace {

constexpr std::string_view kMagic = "rgbd_pose_map ";
constexpr std::string_view kVersion = "1";
constexpr char kColumns[] =
    "# camera width height fx fy cx cy k1 k2 p1 p2 k3 (k4 k5 k6 lens)\n"
    "# keyframe id segment timestamp depth_delay depth_scale tx ty tz qx qy "
    "qz qw gray depth\n"
    "# edge ref cur tx ty tz qx qy qz qw covariance (6 x 6)\n";

// Names of lens models.
constexpr char kRational[] = "rational";
constexpr char kEquidistant[] = "equidistant";

// Writes the words of a line.
class LineWriter {
 public:
  LineWriter(const char* kind, std::string* text) : text_(*text) {
    text_ += kind;
  }
  ~LineWriter() { text_ += '\n'; }
  LineWriter(const LineWriter&) = delete;
  LineWriter& operator=(const LineWriter&) = delete;

  void Word(const std::string& word) { text_ += ' ' + word; }
  void Integer(int value) { Word(std::to_string(value)); }
  void Number(double value) { Word(ShortNumber(value)); }
  void Motion(const Rigid3d& motion) {
    for (int i = 0; i < 3; ++i) Number(motion.translation[i]);
    for (int i = 0; i < 4; ++i) Number(motion.rotation.coeffs()[i]);
  }

 private:
  std::string& text_;
};

// Reads the words of a line one after the other.
class LineReader {
 public:
  LineReader(const TextLine& line, const std::string& path)
      : line_(line), path_(path) {}

  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(path_, line_.number, what);
  }
  void Require(size_t words) const {
    if (line_.words.size() == words) return;
    Fail("a line '" + Kind() + "' must have " + std::to_string(words) +
         " words, this one has " + std::to_string(line_.words.size()));
  }
  const std::string& Kind() const { return line_.words[0]; }
  size_t Count() const { return line_.words.size(); }
  const std::string& Word() { return line_.words[next_++]; }
  double Number() {
    return ParseNumber(Word(), path_, line_.number, "a " + Kind());
  }
  int Integer() {
    const double value = Number();
    constexpr double kMax = std::numeric_limits<int>::max();
    if (value != std::floor(value) || std::abs(value) > kMax) {
      Fail("'" + line_.words[next_ - 1] + "' must be an integer");
    }
    return static_cast<int>(value);
  }
  // Avoids the constructor of Rigid3d, which might change the last digit.
  Rigid3d Motion() {
    Rigid3d motion;
    for (int i = 0; i < 3; ++i) motion.translation[i] = Number();
    for (int i = 0; i < 4; ++i) motion.rotation.coeffs()[i] = Number();
    return motion;
  }
  std::string ImageName() {
    const std::string& word = Word();
    if (!IsImageName(word)) Fail("'" + word + "' must be an image's checksum");
    return word;
  }

 private:
  const TextLine& line_;
  const std::string& path_;
  size_t next_ = 1;
};

void ReadCamera(LineReader* line, Camera* camera) {
  const bool is_usual = line->Count() <= 3 + kNumUsualParameters;
  const size_t count =
      is_usual ? kNumUsualParameters : kCameraParameters.size();
  line->Require(3 + count + (is_usual ? 0 : 1));
  camera->width = line->Integer();
  camera->height = line->Integer();
  for (size_t i = 0; i < count; ++i) {
    camera->*kCameraParameters[i].value = line->Number();
  }
  if (is_usual) return;
  const std::string& lens = line->Word();
  if (lens != kRational && lens != kEquidistant) {
    line->Fail("lens '" + lens + "' must be 'rational' or 'equidistant'");
  }
  if (lens == kEquidistant) camera->lens_model = LensModel::kEquidistant;
}

void ReadKeyframe(LineReader* line, MapIndex* index) {
  line->Require(15);
  Keyframe keyframe;
  keyframe.id = line->Integer();
  keyframe.segment = line->Integer();
  keyframe.images.timestamp = line->Number();
  keyframe.images.depth_delay = line->Number();
  keyframe.images.depth_scale = line->Number();
  keyframe.world_from_cam = line->Motion();
  const std::string gray = line->ImageName();
  index->images.push_back({gray, line->ImageName()});
  index->map.keyframes.push_back(std::move(keyframe));
}

void ReadEdge(LineReader* line, std::vector<RelativePose>* edges) {
  line->Require(46);
  RelativePose edge;
  edge.ref = line->Integer();
  edge.cur = line->Integer();
  edge.cur_from_ref = line->Motion();
  for (int i = 0; i < 36; ++i) edge.covariance(i / 6, i % 6) = line->Number();
  edges->push_back(edge);
}

// Checks the first and the last line of a text and returns it without the last.
std::string_view Unseal(std::string_view text, const std::string& path) {
  if (text.substr(0, kMagic.size()) != kMagic) {
    throw InputError(path + ": is not a map of rgbd_slam");
  }
  const size_t line_end = std::min(text.find('\n'), text.size());
  const std::string_view version =
      text.substr(kMagic.size(), line_end - kMagic.size());
  if (version != kVersion) {
    constexpr size_t kShown = 20;  // the line of a damaged file may not end
    throw InputError(path + ": has format version " +
                     std::string(version.substr(0, kShown)) +
                     ", this program reads version " + std::string(kVersion) +
                     " only; use a newer program");
  }
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
  TextHash hash;
  hash.Add(above);
  return "checksum " + hash.Hex() + "\n";
}

bool IsImageName(std::string_view word) {
  return word.size() == 16 &&
         word.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

std::string FormatMapIndex(const MapIndex& index) {
  std::string text;
  ((text += kMagic) += kVersion) += '\n';
  text += kColumns;
  {
    const Camera& camera = index.map.camera;
    LineWriter line("camera", &text);
    line.Integer(camera.width);
    line.Integer(camera.height);
    // The long form is used if the short one cannot express the lens.
    const bool is_equidistant = camera.lens_model == LensModel::kEquidistant;
    const bool is_usual =
        !is_equidistant &&
        camera.MakeLens().factor != Lens<double>::Factor::kRational;
    for (size_t i = 0; i < kCameraParameters.size(); ++i) {
      if (is_usual && i == kNumUsualParameters) break;
      line.Number(camera.*kCameraParameters[i].value);
    }
    if (!is_usual) line.Word(is_equidistant ? kEquidistant : kRational);
  }
  for (size_t i = 0; i < index.map.keyframes.size(); ++i) {
    const Keyframe& keyframe = index.map.keyframes[i];
    LineWriter line("keyframe", &text);
    line.Integer(keyframe.id);
    line.Integer(keyframe.segment);
    line.Number(keyframe.images.timestamp);
    line.Number(keyframe.images.depth_delay);
    line.Number(keyframe.images.depth_scale);
    line.Motion(keyframe.world_from_cam);
    line.Word(index.images[i].gray);
    line.Word(index.images[i].depth);
  }
  for (const RelativePose& edge : index.map.edges) {
    LineWriter line("edge", &text);
    line.Integer(edge.ref);
    line.Integer(edge.cur);
    line.Motion(edge.cur_from_ref);
    for (int i = 0; i < 36; ++i) line.Number(edge.covariance(i / 6, i % 6));
  }
  return text + ChecksumLine(text);
}

MapIndex ParseMapIndex(std::string_view text, const std::string& path) {
  const std::vector<TextLine> lines = SplitTextTable(Unseal(text, path));
  MapIndex index;
  for (size_t i = 1; i < lines.size(); ++i) {
    LineReader line(lines[i], path);
    if ((i == 1) != (line.Kind() == "camera")) {
      line.Fail("there must be one camera line, before all others");
    }
    if (line.Kind() == "camera") {
      ReadCamera(&line, &index.map.camera);
    } else if (line.Kind() == "keyframe") {
      ReadKeyframe(&line, &index);
    } else if (line.Kind() == "edge") {
      ReadEdge(&line, &index.map.edges);
    } else {
      line.Fail("'" + line.Kind() + "' must be camera, keyframe or edge");
    }
  }
  if (lines.size() < 2) throw InputError(path + ": has no camera");
  return index;
}

}  // namespace rgbd_pose
