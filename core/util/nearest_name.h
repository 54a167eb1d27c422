#pragma once

#include <string>
#include <vector>

namespace rgbd_pose {

// The name that `name` was probably meant to be: the first of those with the
// fewest letters to insert, delete or replace, if these are at most `most`.
// Upper and lower case are the same. Empty if there is none.
std::string NearestName(const std::string& name,
                        const std::vector<std::string>& names, int most);

}  // namespace rgbd_pose
