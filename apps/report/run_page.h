#pragma once

#include <filesystem>
#include <string>

namespace rgbd_pose {

// Writes report.html into the folder of a run that is not published yet, `out`
// being the one it will have. Returns what a program prints of it: where it is,
// or that this build writes none. A disk that is too full for the page costs no
// other result: the part of it is removed, and `why_not` says so.
std::string WriteRunPage(const std::filesystem::path& staging_dir,
                         const std::string& out, std::string* why_not);

}  // namespace rgbd_pose
