#pragma once

#include <memory>

#include "frontend/sources/frame_source.h"
#include "frontend/sources/source_options.h"

namespace rgbd_pose {

// Opens a camera that OpenNI 2 has a driver for (Kinect, Xtion, Astra), by its
// URI, or `any`. It registers depth to colour itself, unless the options say
// where the depth camera is. Frames that come faster than they are asked for
// are dropped (LatestFrame). The lens is what its angle of view says, if the
// options say nothing better. Throws InputError for what is not there or has no
// colour or no depth, and in a build without OpenNI 2.
std::unique_ptr<FrameSource> OpenOpenNi2(const SourceOptions& options);

}  // namespace rgbd_pose
