#pragma once

#include <string>
#include <vector>

namespace rgbd_pose {

// Sets flags of gflags from words such as "--name=value", "--name value",
// "--switch" and "--noswitch", and from files that --flagfile names: a flag a
// line, "#" before comments, CRLF and a byte order mark taken. (gflags' own
// reader ends the process at the first bad flag and takes flags of its own that
// list those of every library.) The last value counts. Throws InputError for
// anything else: an unknown flag, a value of the wrong type, a word that is no
// flag.
void ReadFlags(const std::vector<std::string>& words);

}  // namespace rgbd_pose
