#include "core/evaluation/truth_noise.h"

#include <vector>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

constexpr char kKey[] = "truth_sigma:";

TruthNoise ParseLine(const std::vector<std::string>& words,
                     const std::string& path, int line) {
  if (words.size() != 5 || words[2] != "m" || words[4] != "deg") {
    throw InputError(path, line,
                     "must have the form '# truth_sigma: 0.002 m 0.2 deg'");
  }
  const double metres = ParseNumber(words[1], path, line, kKey);
  const double degrees = ParseNumber(words[3], path, line, kKey);
  if (metres < 0.0 || degrees < 0.0) {
    throw InputError(path, line, "sigmas must not be negative");
  }
  return {metres, degrees * kRadiansPerDegree, "as its file says"};
}

}  // namespace

std::string TruthNoise::InWords() const {
  if (translation == 0.0 && rotation == 0.0) {
    return origin.empty() ? "assumed exact" : "exact, " + origin;
  }
  return Format("sigma %g mm, %g deg", translation * kMillimetresPerMetre,
                rotation * kDegreesPerRadian) +
         (origin.empty() ? "" : ", " + origin);
}

TruthNoise ReadTruthNoise(const std::string& path) {
  const std::string content = ReadTextFile(path);
  TruthNoise noise;
  int number = 0;
  for (const std::string& line :
       SplitText(WithoutByteOrderMark(content), '\n')) {
    ++number;
    if (line.empty() || line[0] != '#') break;
    const std::vector<TextLine> table = SplitTextTable(line.substr(1));
    if (!table.empty() && table.front().words.front() == kKey) {
      return ParseLine(table.front().words, path, number);
    }
    if (noise.origin.empty()) noise = TruthNoiseByName(line);
  }
  return noise;
}

TruthNoise TruthNoiseByName(std::string_view text) {
  if (text.find("rgbd_dataset_freiburg") == text.npos) return {};
  // Errors of the motions of a moving camera by its markers, their mounting on
  // the camera and its clock: docs/reference/sequences.md.
  return {0.002, 0.2 * kRadiansPerDegree, "as known of the TUM benchmark"};
}

std::string FormatTruth(const Trajectory& truth, const TruthNoise& noise) {
  std::string head;
  if (!noise.origin.empty()) {
    head = Format("# %s %.6g m %.6g deg\n", kKey, noise.translation,
                  noise.rotation * kDegreesPerRadian);
  }
  return head + FormatTrajectory(truth);
}

}  // namespace rgbd_pose
