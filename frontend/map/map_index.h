#pragma once

#include <string>
#include <string_view>

#include "frontend/map/keyframe_map.h"

namespace rgbd_pose {

// The index of a map, its text file (docs/maps.md): everything but the images,
// which are named by their checksums. Equal maps give equal text.
std::string FormatMapIndex(const KeyframeMap& map);

// Parses the text of an index; numbers are exactly those that were written, and
// images have checksums, but no bytes. Throws InputError, which names `path`,
// for a text that is no map, of another version, damaged or edited. Does not
// check the map (KeyframeMap::Check).
KeyframeMap ParseMapIndex(std::string_view text, const std::string& path);

// The last line of an index: the checksum of the text above it.
std::string ChecksumLine(std::string_view above);

// Whether a word has the form of an image name, a checksum.
bool IsImageName(std::string_view word);

}  // namespace rgbd_pose
