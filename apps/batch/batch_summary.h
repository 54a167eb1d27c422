#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/batch/batch_plan.h"
#include "apps/batch/batch_run_folder.h"

namespace rgbd_pose {

// A row for every run of a plan, in its order, of what its folder holds: keys
// with units, null for what is not known, times last. Runs without a result of
// the same hash have the status "missing".
using BatchSummary = std::vector<nlohmann::ordered_json>;

BatchSummary Summarise(const std::vector<BatchRun>& runs,
                       const BatchFolder& folder);

// How many rows have another status than "ok".
int CountNotOk(const BatchSummary& summary);

// For programs: a header and a row a run; a JSON array of objects.
std::string FormatBatchCsv(const BatchSummary& summary);
std::string FormatBatchJson(const BatchSummary& summary);

// For people: the main figures of each run; of several parts of a sequence
// their median, least and most instead.
std::string FormatBatchTable(const BatchSummary& summary);

}  // namespace rgbd_pose
