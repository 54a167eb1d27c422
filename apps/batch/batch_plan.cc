#include "apps/batch/batch_plan.h"

#include <link.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "core/geometry/camera.h"
#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"
#include "core/util/text_hash.h"
#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/sources/frame_range.h"
#include "frontend/sources/masks.h"
#include "frontend/tracking/tracker_factory.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

void CheckKnown(const std::string& name,
                const std::vector<std::string>& known) {
  if (std::count(known.begin(), known.end(), name) == 0) {
    throw UnknownName("name", name, known);
  }
}

std::vector<std::string> ParseList(const BatchSetting& setting,
                                   const std::string& text) {
  std::vector<std::string> values;
  for (const std::string& value : SplitList(text)) {
    Located(std::string("--") + setting.list, [&] {
      if (std::count(values.begin(), values.end(), value) > 0) {
        throw InputError("'" + value + "' appears twice");
      }
      setting.check(value);
    });
    values.push_back(value);
  }
  return values;
}

std::optional<int> FromEnvironment(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? std::nullopt : ParseWhole(text);
}

BatchShard ShardOfSlurmTask() {
  const std::optional<int> id = FromEnvironment("SLURM_ARRAY_TASK_ID");
  const std::optional<int> count = FromEnvironment("SLURM_ARRAY_TASK_COUNT");
  if (!id || !count) return {};
  const int first = FromEnvironment("SLURM_ARRAY_TASK_MIN").value_or(0);
  if (*id < first || *id - first >= *count) {
    throw InputError("Slurm array task " + std::to_string(*id) +
                     " has no shard: the array has " + std::to_string(*count) +
                     " tasks from " + std::to_string(first) +
                     "; use an array without gaps (0-9), or give --shard");
  }
  return {*id - first, *count};
}

namespace fs = std::filesystem;

void AddFile(const fs::path& path, TextHash* hash) {
  hash->Add(IsFile(path) ? "file" : "none");
  if (IsFile(path)) hash->Add(ReadTextFile(path.string()));
}

int AddOwnLibrary(dl_phdr_info* library, size_t /*size*/, void* hash) {
  const fs::path path = library->dlpi_name;
  if (path.filename().string().rfind("librgbd_pose_", 0) == 0) {
    AddFile(path, static_cast<TextHash*>(hash));
  }
  return 0;  // continue
}

void AddSize(const fs::path& file, TextHash* hash) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  hash->Add(error ? "none" : std::to_string(size));
}

// Accepts any lines; the run checks whether they are valid.
void AddImagesOf(const fs::path& folder, const char* list, TextHash* hash) {
  AddFile(folder / list, hash);
  if (!IsFile(folder / list)) return;
  for (const TextLine& line : ReadTextTable(folder / list)) {
    if (line.words.size() < 2) continue;
    const fs::path image = folder / line.words[1];
    AddSize(image, hash);
    AddSize(MaskPath(image.string()), hash);
  }
}

// Hashes a file, or everything in a folder of another kind: names, sizes and
// texts.
void AddAllOf(const fs::path& recording, TextHash* hash) {
  std::error_code error;
  std::vector<fs::path> files;
  if (IsFile(recording)) files.push_back(recording);
  for (const fs::directory_entry& entry :
       fs::recursive_directory_iterator(recording, error)) {
    if (entry.is_regular_file(error)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    hash->Add(file.lexically_relative(recording).string());
    AddSize(file, hash);
    // The extensions of all files but images and bags.
    static const std::set<std::string> kTexts = {
        ".txt", ".json", ".log", ".csv", ".yaml", ".yml", ".freiburg"};
    if (kTexts.count(file.extension()) > 0) AddFile(file, hash);
  }
}

}  // namespace

const std::vector<BatchSetting>& BatchSettings() {
  static const std::vector<BatchSetting> settings = {
      {"costs", "cost", "cost",
       [](const std::string& name) {
         for (const std::string& part : SplitList(name, '+')) {
           CheckKnown(part, CostNames());
         }
       }},
      {"losses", "loss", "loss", ParseLoss},
      {"frontends", "frontend", "frontend",
       [](const std::string& name) { CheckKnown(name, FrontendNames()); }},
      {"trackers", "tracker", "tracker",
       [](const std::string& name) { CheckKnown(name, TrackerNames()); }},
      {"parts", "frames", "part", ParseFrameRange},
  };
  return settings;
}

std::string BatchRun::Name() const {
  std::string name = sequence.name + "/";
  for (const std::string& value : values) {
    name += value;
    // A value such as 3- already ends with a dash.
    if (name.back() != '-' && name.back() != '/') name += "-";
  }
  return name + "r" + std::to_string(repeat);
}

BatchGrid ParseGrid(const std::vector<std::string>& lists, int repeats) {
  if (repeats < 1 || repeats > 10000) {
    throw InputError("--repeats must be 1 to 10000");
  }
  BatchGrid grid = {{{}}, repeats};
  for (size_t k = 0; k < lists.size(); ++k) {
    const auto values = ParseList(BatchSettings()[k], lists[k]);
    for (const auto& begun : std::exchange(grid.combinations, {})) {
      for (const std::string& value : values) {
        grid.combinations.push_back(begun);
        grid.combinations.back().push_back(value);
      }
    }
  }
  return grid;
}

std::vector<BatchRun> MakePlan(const std::vector<BatchSequence>& sequences,
                               const BatchGrid& grid, const BatchShard& shard,
                               const std::string& settings) {
  std::vector<BatchRun> runs;
  for (size_t i = 0; i < sequences.size(); ++i) {
    if (!shard.Has(static_cast<int>(i))) continue;
    const std::string inputs = HashSequence(sequences[i]);
    for (const std::vector<std::string>& values : grid.combinations) {
      TextHash hash;
      for (const std::string& value : values) hash.Add(value);
      hash.Add(settings);
      hash.Add(inputs);
      for (int repeat = 1; repeat <= grid.repeats; ++repeat) {
        runs.push_back({sequences[i], values, repeat, hash.Hex()});
      }
    }
  }
  return runs;
}

BatchShard ParseShard(const std::string& text) {
  if (text.empty()) return ShardOfSlurmTask();
  const size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const std::string_view view = text;
    const std::optional<int> index = ParseWhole(view.substr(0, slash));
    const std::optional<int> count = ParseWhole(view.substr(slash + 1));
    if (index && count && *index < *count) return {*index, *count};
  }
  throw InputError("--shard=" + text +
                   ": must be i/n with i from 0 to n - 1, such as 0/4");
}

std::string HashProgram(const std::string& path) {
  TextHash hash;
  AddFile(path, &hash);
  dl_iterate_phdr(AddOwnLibrary, &hash);
  return hash.Hex();
}

std::string HashSequence(const BatchSequence& sequence) {
  TextHash hash;
  if (IsFile(fs::path(sequence.folder) / "rgb.txt")) {
    AddImagesOf(sequence.folder, "rgb.txt", &hash);
    AddImagesOf(sequence.folder, "depth.txt", &hash);
    for (const char* file :
         {"groundtruth.txt", "calibration.txt", "camera.yaml", "imu.yaml",
          "imu.csv", "imu.txt", "accelerometer.txt"}) {
      AddFile(fs::path(sequence.folder) / file, &hash);
    }
  } else {
    AddAllOf(sequence.folder, &hash);
  }
  if (CameraPreset(sequence.camera)) {
    hash.Add(sequence.camera);
  } else {
    AddFile(sequence.camera, &hash);
  }
  return hash.Hex();
}

}  // namespace rgbd_pose
