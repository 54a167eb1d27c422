#pragma once

#include <memory>
#include <string>

#include "frontend/bags/bag_reader.h"
#include "frontend/sources/frame_source.h"
#include "frontend/sources/numbered_layouts.h"
#include "frontend/sources/source_options.h"

namespace rgbd_pose {

// What the table in open_source.cc opens but for TumDataset. All throw
// InputError if neither the recording nor the options say what camera it was.

// The frames of a bag, of ROS 1 or 2: colour and depth images paired by their
// stamps while they are read, so that only the frames under way are in memory.
// Its own camera is that of its CameraInfo, the true path what /tf has said so
// far of how the colour camera moved in the frame `world`, as a motion capture
// system publishes it. Throws InputError if it has no colour or no depth
// images; Next if no two images belong together at all and, where the bag is
// damaged, after the frames before that. A damaged message is a frame that
// cannot be read.
std::unique_ptr<FrameSource> OpenBagSource(std::unique_ptr<BagReader> bag,
                                           const SourceOptions& options);

// Whether a folder has images and the mark of a layout.
bool IsNumbered(const NumberedLayout& layout, const std::string& folder);

// A recording in numbered files: a frame is a colour and a depth image of the
// same number; its time stamp is that number over kNumberedRate. Throws
// InputError if there are no such files.
std::unique_ptr<FrameSource> OpenNumbered(const NumberedLayout& layout,
                                          const SourceOptions& options);

// Opens a camera that OpenNI 2 has a driver for (Kinect, Xtion, Astra), by its
// URI, or `any`. It registers depth to colour itself, unless the options say
// where the depth camera is. Frames that come faster than they are asked for
// are dropped (LatestFrame). The lens is what its angle of view says, if the
// options say nothing better. Throws InputError for what is not there or has no
// colour or no depth, and in a build without OpenNI 2.
std::unique_ptr<FrameSource> OpenOpenNi2(const SourceOptions& options);

}  // namespace rgbd_pose
