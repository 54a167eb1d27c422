#pragma once

#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// The pose world_from_cam at time t of a path that lasts `duration` (both in
// seconds; 0 <= t <= duration, or up to a frame outside).
using SyntheticPath = Rigid3d (*)(double t, double duration);

// The path with this name, for the scene "room" unless noted. Throws
// InputError that lists the names if there is none. Camera axes: x right, y
// down, z forward.
//   xyz       0.2 m along the camera's x, y and z axis and back, then the same
//             in the opposite directions; 5 s per round, at most 0.38 m/s and
//             rotations of about 1 degree, as in TUM's freiburg1_xyz
//   pan_tilt  pan 0, +20, -20, 0 degrees, then tilt 0, +12, -12, 0 degrees,
//             stopping smoothly at each; the camera's centre is a few cm off
//             both axes. Stretched over `duration` (38 deg/s at most in 5 s):
//             the last pose is exactly the first
//   circle    a level circle of 0.3 m radius in 9 s, looking at the desk
//   still     no motion
//   walk      straight ahead at walking pace, 3 m within 4 s, and back, with
//             the sway of steps: for the scene "corridor"
//   handheld  swings of arm and hand on all six axes, up to 1.0 m/s and 90
//             deg/s (0.96 and 87 reached within the first 5 s)
//   whip_pan  along xyz, with half a turn to the left or back every 3 s: 0.5 s
//             at 300 deg/s and 0.1 s each to start and to stop, first at 1.15 s
//   whip_pan_fast  the same at 600 deg/s: 0.2 s, first at 1.3 s
// Carried by hand through the scene of the same name, at up to 0.6 m/s
// and 40 deg/s:
//   table           19 m around the desks in 56 s, repeatedly
//   two_rooms       22 m through both rooms and the door, and back, in 57 s,
//                   repeatedly; looks in another direction on the way back
//   twin_corridors  18 m through both in 55 s, and back in the next 55 s
SyntheticPath FindSyntheticPath(const std::string& name);

// The names of all paths.
std::vector<std::string> SyntheticPathNames();

}  // namespace rgbd_pose
