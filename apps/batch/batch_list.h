#pragma once

#include <string>
#include <vector>

namespace rgbd_pose {

// A sequence of a batch.
struct BatchSequence {
  std::string name;    // folder name in the output; unique in a list
  std::string folder;  // absolute
  std::string camera;  // a preset or an absolute path
};

// Reads a list of sequences, one per line: a folder and optionally its camera
// (preset or YAML file; default: camera.yaml of the folder). Paths are relative
// to the folder of the list. A folder may be a pattern (*, ?, [...]), which
// stands for all matches in order of name. Throws InputError (file:line) for a
// line without a valid folder or camera and for duplicate names.
std::vector<BatchSequence> ReadSequenceList(const std::string& path);

}  // namespace rgbd_pose
