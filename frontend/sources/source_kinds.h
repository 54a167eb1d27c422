#pragma once

#include <memory>
#include <string>

#include "frontend/bags/bag_reader.h"
#include "frontend/sources/dataset.h"
#include "frontend/sources/numbered_layouts.h"
#include "frontend/sources/source_options.h"

namespace rgbd_pose {

// The sources in the table of open_source.cc. All throw InputError if neither
// the recording nor the options specify the camera.

// A sequence in the layout of the TUM RGB-D benchmark: rgb.txt and depth.txt,
// paired by nearest time (see Associate), or the lines of the associations
// file. Images with the time stamp of another are left out. Its own camera is
// in camera.yaml, as written by rgbd_simulate, or in calibration.txt (fx fy cx
// cy), as in ETH3D; its true path in groundtruth.txt, if that exists. Throws
// InputError (file:line) for wrong columns and for decreasing time stamps.
std::unique_ptr<Dataset> OpenTum(const SourceOptions& options);

// The frames of a ROS 1 or ROS 2 bag, whose images are paired by their stamps
// while they are read. The bag's own camera comes from its CameraInfo. The true
// path is the motion of the colour camera in the frame `world` according to the
// /tf messages read so far, as a motion capture system publishes them. Throws
// InputError if the bag has no colour or no depth images. Next throws it if no
// two images form a pair and, if the bag is damaged, after the frames before
// the damage. A damaged message counts as an unreadable frame.
std::unique_ptr<FrameSource> OpenBagSource(std::unique_ptr<BagReader> bag,
                                           const SourceOptions& options);

// Whether a folder has the images and the mark of a layout.
bool IsNumbered(const NumberedLayout& layout, const std::string& folder);

// A recording in numbered files. A frame is a colour and a depth image with the
// same number; its time stamp is the number / kNumberedRate. Throws InputError
// if there are no such files.
std::unique_ptr<FrameSource> OpenNumbered(const NumberedLayout& layout,
                                          const SourceOptions& options);

// A folder that the app Stray Scanner recorded with a phone with LiDAR. Images
// of rgb.mp4 are scaled to at most 640 px width, or to the width of the
// options' camera, and to the focal length of camera_matrix.csv; depth/ and
// confidence/ are resampled to that size. ARKit's path in odometry.csv is the
// ground truth. Throws InputError for missing or inconsistent files, and in a
// build without video; Next throws it where the video ends too early.
std::unique_ptr<FrameSource> OpenStrayScanner(const SourceOptions& options);

// A camera with an OpenNI 2 driver (Kinect, Xtion, Astra) by its URI, or `any`,
// as a LatestFrame. The camera registers depth to colour unless the options
// specify the depth camera. Without a camera in the options the focal lengths
// follow from the angles of view. Throws InputError if the camera is missing or
// has no colour or no depth, and in a build without OpenNI 2.
std::unique_ptr<FrameSource> OpenOpenNi2(const SourceOptions& options);

}  // namespace rgbd_pose
