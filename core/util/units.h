#pragma once

namespace rgbd_pose {

// For people and files of others; inside, all is in radians and metres.
constexpr double kDegreesPerRadian = 57.29577951308232;
constexpr double kRadiansPerDegree = 0.017453292519943295;
constexpr double kMillimetresPerMetre = 1000.0;

}  // namespace rgbd_pose
