#pragma once

#include <memory>
#include <string>

#include "frontend/bags/bag_reader.h"
#include "frontend/sources/numbered_layouts.h"
#include "frontend/sources/open_source.h"

namespace rgbd_pose {

// The other sources in the table of open_source.cc; docs/sources.md describes
// their formats. All throw InputError if the recording or a part of it is
// missing, or if neither the recording nor the options specify the camera.

// Pairs images while they are read. The true path is known as far as messages
// were read. Next throws InputError if no two images form a pair and, if the
// bag is damaged, after the frames before the damage. A damaged message counts
// as an unreadable frame.
std::unique_ptr<FrameSource> OpenBagSource(std::unique_ptr<BagReader> bag,
                                           const SourceOptions& options);

// Whether a folder has the images and the mark of a layout.
bool IsNumbered(const NumberedLayout& layout, const std::string& folder);

// Whether it has the mark and the colour images at least.
bool HasNumberedColor(const NumberedLayout& layout, const std::string& folder);

// Pairs images of the same number; the time stamp is number / kNumberedRate.
std::unique_ptr<FrameSource> OpenNumbered(const NumberedLayout& layout,
                                          const SourceOptions& options);

// Whether a folder has a transforms.json with depth.
bool IsNerfstudio(const std::string& folder);

// The images and poses in transforms.json, in its order, kNumberedRate a
// second.
std::unique_ptr<FrameSource> OpenNerfstudio(const SourceOptions& options);

// Whether a folder has images of colour and depth with times in their names.
bool IsSun3d(const std::string& folder);

// Pairs the images of SUN3D or of Redwood's scans by the times in their names.
std::unique_ptr<FrameSource> OpenSun3d(const SourceOptions& options);

// Throws InputError also for inconsistent files and in a build without video;
// Next throws it where the video ends too early.
std::unique_ptr<FrameSource> OpenStrayScanner(const SourceOptions& options);

// A folder of the app Record3D; its path is that of ARKit. Throws InputError
// also for inconsistent files; in a build without OpenEXR, Read does.
std::unique_ptr<FrameSource> OpenRecord3d(const SourceOptions& options);

// A LatestFrame of the camera with this URI, or of `any`. Throws InputError
// also in a build without OpenNI 2.
std::unique_ptr<FrameSource> OpenOpenNi2(const SourceOptions& options);

}  // namespace rgbd_pose
