#pragma once

namespace rgbd_pose {

// For output and foreign files; internal values are in radians and metres.
constexpr double kDegreesPerRadian = 57.29577951308232;
constexpr double kRadiansPerDegree = 0.017453292519943295;
constexpr double kMillimetresPerMetre = 1000.0;

}  // namespace rgbd_pose
