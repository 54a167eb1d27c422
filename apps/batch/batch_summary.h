#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/batch/batch_plan.h"
#include "apps/batch/batch_run_folder.h"

namespace rgbd_pose {

// One row per run of a plan, in plan order, from the files in its folder. Keys
// include units, unknown values are null, and times are last. A run without a
// result of the same hash has the status "missing".
using BatchSummary = std::vector<nlohmann::ordered_json>;

BatchSummary Summarise(const std::vector<BatchRun>& runs,
                       const BatchFolder& folder);

// The number of rows whose status is not "ok".
int CountNotOk(const BatchSummary& summary);

// For programs: CSV with a header and one row per run; a JSON array of objects.
std::string FormatBatchCsv(const BatchSummary& summary);
std::string FormatBatchJson(const BatchSummary& summary);

// For people: the main figures of each run. If a sequence has several parts,
// their median, minimum and maximum instead.
std::string FormatBatchTable(const BatchSummary& summary);

}  // namespace rgbd_pose
