#include "apps/batch/batch_plan.h"

#include <algorithm>
#include <functional>

#include "apps/batch/batch_hash.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "core/util/text_hash.h"
#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  size_t begin = 0;
  for (size_t end; (end = text.find(separator, begin)) != std::string::npos;
       begin = end + 1) {
    parts.push_back(text.substr(begin, end - begin));
  }
  parts.push_back(text.substr(begin));
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

std::vector<std::string> ParseNames(
    const std::string& flag, const std::string& text,
    const std::function<void(const std::string& name)>& check) {
  std::vector<std::string> names;
  for (const std::string& name : Split(text, ',')) {
    try {
      if (Contains(names, name)) {
        throw InputError("'" + name + "' comes twice");
      }
      check(name);
    } catch (const InputError& error) {
      throw InputError("--" + flag + ": " + error.what());
    }
    names.push_back(name);
  }
  return names;
}

std::string HashRun(const BatchRun& run, const std::string& settings,
                    const std::string& inputs) {
  TextHash hash;
  for (const std::string& text :
       {run.cost, run.loss, run.frontend, settings, inputs}) {
    hash.Add(text);
  }
  return hash.Hex();
}

}  // namespace

std::string BatchRun::Name() const {
  return sequence.name + "/" + cost + "-" + loss + "-" + frontend + "-r" +
         std::to_string(repeat);
}

BatchGrid ParseGrid(const std::string& costs, const std::string& losses,
                    const std::string& frontends, int repeats) {
  if (repeats < 1 || repeats > 10000) {
    throw InputError("--repeats must be 1 to 10000");
  }
  const auto check_cost = [](const std::string& name) {
    for (const std::string& part : Split(name, '+')) {
      CheckKnown(part, CostNames());
    }
  };
  const auto check_frontend = [](const std::string& name) {
    CheckKnown(name, FrontendNames());
  };
  return {ParseNames("costs", costs, check_cost),
          ParseNames("losses", losses, ParseLoss),
          ParseNames("frontends", frontends, check_frontend), repeats};
}

std::vector<BatchRun> MakePlan(const std::vector<BatchSequence>& sequences,
                               const BatchGrid& grid, const BatchShard& shard,
                               const std::string& settings) {
  std::vector<BatchRun> runs;
  for (size_t i = 0; i < sequences.size(); ++i) {
    if (!shard.Has(static_cast<int>(i))) continue;
    const std::string inputs = HashSequence(sequences[i]);
    for (const std::string& cost : grid.costs) {
      for (const std::string& loss : grid.losses) {
        for (const std::string& frontend : grid.frontends) {
          for (int repeat = 1; repeat <= grid.repeats; ++repeat) {
            runs.push_back({sequences[i], cost, loss, frontend, repeat, ""});
            runs.back().hash = HashRun(runs.back(), settings, inputs);
          }
        }
      }
    }
  }
  return runs;
}

}  // namespace rgbd_pose
