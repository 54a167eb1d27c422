#pragma once

#include <string>
#include <string_view>

#include "frontend/slam/keyframe_map.h"

namespace rgbd_pose {

// A map is stored in a folder: a text file, map.txt, and the images of its
// keyframes, each as a PNG file named by its checksum (docs/maps.md).

// Saves a map and replaces the one in the folder. Existing images are not
// written again: an extended map costs only its new images. If the program is
// killed or the power fails, the folder contains either the old map or the new
// one. Throws InputError and keeps the old map if the map is invalid
// (KeyframeMap::Check) or if the folder cannot be written to, contains anything
// but a map or a map of another version, or is being saved to by another
// program.
void SaveMap(const std::string& folder, const KeyframeMap& map);

// Creates the folder. Throws as SaveMap would, but before a long computation.
void RequireMapFolder(const std::string& folder);

// Whether the folder contains a map, be it damaged.
bool HasMap(const std::string& folder);

// Loads a map with exactly the saved numbers and images. Throws InputError if
// there is no map, a map of another version, or one that is damaged or lacks an
// image. Another program may save to the folder at the same time.
KeyframeMap LoadMap(const std::string& folder);

// The index of a map, its text file (docs/maps.md): everything but the images,
// which are named by their checksums. Equal maps give equal text.
std::string FormatMapIndex(const KeyframeMap& map);

// Parses the text of an index; numbers are exactly those that were written, and
// images have checksums, but no bytes. Throws InputError, which names `path`,
// for a text that is no map, of another version, damaged or edited. Does not
// check the map (KeyframeMap::Check).
KeyframeMap ParseMapIndex(std::string_view text, const std::string& path);

// Throws InputError, which names `path`, for a text that does not begin as an
// index of this version.
void RequireIndexFormat(std::string_view text, const std::string& path);

// The last line of an index: the checksum of the text above it.
std::string ChecksumLine(std::string_view above);

// Whether a word has the form of an image name, a checksum.
bool IsImageName(std::string_view word);

}  // namespace rgbd_pose
