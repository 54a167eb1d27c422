#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "frontend/map/keyframe_map.h"

namespace rgbd_pose {

// What the text file of a map holds (docs/maps.md): all but the images, which
// it names by their checksums.
struct MapIndex {
  // The names of a keyframe's images.
  struct ImageNames {
    std::string gray;
    std::string depth;
  };

  KeyframeMap map;                 // with keyframes without images
  std::vector<ImageNames> images;  // of each keyframe
};

// The text; the same index always gives the same.
std::string FormatMapIndex(const MapIndex& index);

// The index that a text is of; the very numbers that were written. Throws
// InputError naming `path` for a text that is no map, of a newer version,
// damaged or edited. The map is not checked.
MapIndex ParseMapIndex(std::string_view text, const std::string& path);

// The last line of an index: the checksum of what is above.
std::string ChecksumLine(std::string_view above);

// Whether a word can be the name of an image: a checksum.
bool IsImageName(std::string_view word);

}  // namespace rgbd_pose
