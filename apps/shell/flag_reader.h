#pragma once

#include <string>
#include <vector>

namespace rgbd_pose {

// Sets gflags from words such as "--name=value", "--name value", "--switch" and
// "--noswitch", and from files named by --flagfile. These have one flag per
// line, "#" starts a comment, and CRLF and a byte order mark are accepted. (The
// parser of gflags is not used: it ends the process at the first bad flag and
// accepts flags of its own that list the flags of every library.) The last
// value counts. Throws InputError for an unknown flag, a value of the wrong
// type or a word that is not a flag.
void ReadFlags(const std::vector<std::string>& words);

}  // namespace rgbd_pose
