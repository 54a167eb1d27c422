#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "frontend/map/keyframe_map.h"

namespace rgbd_pose {

// The contents of the text file of a map (docs/maps.md): everything but the
// images, which are named by their checksums.
struct MapIndex {
  struct ImageNames {
    std::string gray;
    std::string depth;
  };

  KeyframeMap map;                 // its keyframes have no images
  std::vector<ImageNames> images;  // by keyframe
};

// The text of an index; equal indices give equal text.
std::string FormatMapIndex(const MapIndex& index);

// Parses the text of an index; numbers are exactly those that were written.
// Throws InputError, which names `path`, for a text that is no map, of another
// version, damaged or edited. Does not check the map (KeyframeMap::Check).
MapIndex ParseMapIndex(std::string_view text, const std::string& path);

// The last line of an index: the checksum of the text above it.
std::string ChecksumLine(std::string_view above);

// Whether a word has the form of an image name, a checksum.
bool IsImageName(std::string_view word);

}  // namespace rgbd_pose
