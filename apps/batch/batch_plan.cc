#include "apps/batch/batch_plan.h"

#include <algorithm>

#include "apps/batch/batch_hash.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "core/util/text_hash.h"
#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/sources/frame_range.h"
#include "frontend/tracking/tracker_factory.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

// Spaces around the parts are not theirs.
std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(separator, begin), text.size());
    std::string part = text.substr(begin, end - begin);
    part.erase(0, part.find_first_not_of(' '));
    part.erase(part.find_last_not_of(' ') + 1);
    parts.push_back(part);
    begin = end + 1;
  }
  return parts;
}

bool Contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void CheckKnown(const std::string& name,
                const std::vector<std::string>& known) {
  if (Contains(known, name)) return;
  throw InputError("unknown name '" + name + "'; there are " + Join(known));
}

std::vector<std::string> ParseList(const BatchSetting& setting,
                                   const std::string& text) {
  std::vector<std::string> values;
  for (const std::string& value : Split(text, ',')) {
    try {
      if (Contains(values, value)) {
        throw InputError("'" + value + "' comes twice");
      }
      setting.check(value);
    } catch (const InputError& error) {
      throw InputError(std::string("--") + setting.list + ": " + error.what());
    }
    values.push_back(value);
  }
  return values;
}

// All combinations, the last list's values fastest.
std::vector<std::vector<std::string>> Combinations(const BatchGrid& grid) {
  std::vector<std::vector<std::string>> all = {{}};
  for (const std::vector<std::string>& values : grid.values) {
    std::vector<std::vector<std::string>> longer;
    for (const std::vector<std::string>& begun : all) {
      for (const std::string& value : values) {
        longer.push_back(begun);
        longer.back().push_back(value);
      }
    }
    all = std::move(longer);
  }
  return all;
}

std::string HashRun(const BatchRun& run, const std::string& settings,
                    const std::string& inputs) {
  TextHash hash;
  for (const std::string& value : run.values) hash.Add(value);
  hash.Add(settings);
  hash.Add(inputs);
  return hash.Hex();
}

}  // namespace

const std::vector<BatchSetting>& BatchSettings() {
  static const std::vector<BatchSetting> settings = {
      {"costs", "cost", "cost",
       [](const std::string& name) {
         for (const std::string& part : Split(name, '+')) {
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
    // A part such as 3- ends with one.
    if (name.back() != '-' && name.back() != '/') name += "-";
  }
  return name + "r" + std::to_string(repeat);
}

BatchGrid ParseGrid(const std::vector<std::string>& lists, int repeats) {
  if (repeats < 1 || repeats > 10000) {
    throw InputError("--repeats must be 1 to 10000");
  }
  BatchGrid grid;
  for (size_t k = 0; k < lists.size(); ++k) {
    grid.values.push_back(ParseList(BatchSettings()[k], lists[k]));
  }
  grid.repeats = repeats;
  return grid;
}

std::vector<BatchRun> MakePlan(const std::vector<BatchSequence>& sequences,
                               const BatchGrid& grid, const BatchShard& shard,
                               const std::string& settings) {
  std::vector<BatchRun> runs;
  const auto combinations = Combinations(grid);
  for (size_t i = 0; i < sequences.size(); ++i) {
    if (!shard.Has(static_cast<int>(i))) continue;
    const std::string inputs = HashSequence(sequences[i]);
    for (const std::vector<std::string>& values : combinations) {
      for (int repeat = 1; repeat <= grid.repeats; ++repeat) {
        runs.push_back({sequences[i], values, repeat, ""});
        runs.back().hash = HashRun(runs.back(), settings, inputs);
      }
    }
  }
  return runs;
}

}  // namespace rgbd_pose
