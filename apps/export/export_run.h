#pragma once

#include <string>
#include <vector>

#include "apps/export/export_format.h"
#include "core/util/named_values.h"

namespace rgbd_pose {

// The options of an export as flags and Python arguments. Sets threads to 0,
// one for each core.
std::vector<Setting> SettingTable(ExportOptions* options);

// What an export has written.
struct WrittenExport {
  std::string path;     // file or folder
  std::string summary;  // the text for users, with the end of its last line
};

// Exports a run to a format of ExportFormats(). An empty output means the
// format's default name in the folder of the run. Throws InputError for an
// unknown format and invalid options, and if the export fails.
WrittenExport ExportRun(const FinishedRun& run, const std::string& format,
                        ExportOptions options);

}  // namespace rgbd_pose
