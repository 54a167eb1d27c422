#pragma once

#include <string>

#include "frontend/map/keyframe_map.h"

namespace rgbd_pose {

// A map kept in a folder: a text file, map.txt, and the images of its
// keyframes, each a PNG file named by its checksum (docs/maps.md).

// Saves a map, in place of the one that is there. Images that are there are not
// written again, so a map that has grown costs what is new of it. Whenever the
// program is killed or the power fails, the folder holds the old map or the new
// one. Throws InputError, with the old map as it was, if the map is not sound
// (KeyframeMap::Check), the folder cannot be written to, holds other things
// than a map, or is just being saved to by another program.
void SaveMap(const std::string& folder, const KeyframeMap& map);

// Makes the folder. Throws InputError if SaveMap could not save to it: to be
// said before the work rather than after it.
void RequireMapFolder(const std::string& folder);

// Loads a map: the very numbers and images that were saved. Throws InputError
// if the folder holds no map, one of a newer version, or one that is damaged or
// lacks an image. Another program may save to the folder meanwhile.
KeyframeMap LoadMap(const std::string& folder);

}  // namespace rgbd_pose
