#pragma once

#include <string>
#include <vector>

namespace rgbd_pose {

// A sequence that a batch works on.
struct BatchSequence {
  std::string name;    // of its folder; no two in a list are the same
  std::string folder;  // absolute
  std::string camera;  // a preset or an absolute path
};

// Reads a list of sequences, one a line: a folder and maybe its camera (preset
// or YAML file; without it camera.yaml of the folder). Paths count from the
// list's own folder; a folder may be a pattern (*, ?, [...]) and stands for all
// that match then, in the order of their names. Throws InputError (file:line)
// for a line that names no folder or no camera and for names that come twice.
std::vector<BatchSequence> ReadSequenceList(const std::string& path);

}  // namespace rgbd_pose
