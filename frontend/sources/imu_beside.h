#pragma once

#include <memory>
#include <string>
#include <vector>

#include "frontend/sources/frame_source.h"
#include "frontend/sources/open_source.h"

namespace rgbd_pose {

// What is known of the inertial sensor of a recording: from SourceOptions::imu,
// from the camera file of the options and from imu.yaml and camera.yaml in the
// folder of the recording, in this order. Throws InputError for bad files.
ImuCalibration ChooseImuCalibration(const SourceOptions& options);

// A source whose frames come with these samples, whose stamps increase.
// `remark` is for users, or empty.
std::unique_ptr<FrameSource> WithImu(std::unique_ptr<FrameSource> source,
                                     const std::vector<ImuSample>& samples,
                                     const ImuSensor& sensor,
                                     const std::string& remark = "");

// Adds the samples of imu.csv, imu.txt or accelerometer.txt in the folder of a
// recording (ReadImuFile). Returns a source without such a file, or with an
// inertial sensor of its own, as it is. Throws InputError for a bad file and
// for one without a sample at the time of the frames.
std::unique_ptr<FrameSource> WithImuBeside(std::unique_ptr<FrameSource> source,
                                           const SourceOptions& options);

}  // namespace rgbd_pose
