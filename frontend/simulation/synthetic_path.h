#pragma once

#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A camera at a place that looks at a point, its x axis level.
Rigid3d LookAt(const Eigen::Vector3d& place, const Eigen::Vector3d& target);

// The pose world_from_cam at time t of a path that lasts `duration` (both in
// seconds, 0 <= t <= duration, or a frame outside).
using SyntheticPath = Rigid3d (*)(double t, double duration);

// A path known by name, of the scene "room" unless it says another. Throws
// InputError that lists the names for another one. Camera axes: x right, y
// down, z forward.
//   xyz       0.2 m along the camera's x, y and z axis and back, then the same
//             towards the other side; 5 s a round at 0.24 m/s on average (0.38
//             at most) with turns of about 1 degree, as TUM's freiburg1_xyz
//   pan_tilt  pan 0, +20, -20, 0 degrees, then tilt 0, +12, -12, 0 degrees,
//             stopping softly at each, the camera's centre a few centimetres
//             off both axes, as on a pan-tilt unit. Stretched over `duration`
//             (38 deg/s at most in 5 s), so that the last pose is exactly the
//             first
//   circle    a level circle of 0.3 m radius once in 9 s, looking at the desk
//   still     no motion
//   walk      straight on at a walking pace, 3 m within 4 s, and back, with a
//             step's sway: for the scene "corridor"
//   handheld  swings of arm and hand on all six axes, up to 1.0 m/s and 90
//             deg/s (0.96 and 87 reached within the first 5 s)
//   whip_pan  along xyz, and half a turn to the left or back every 3 s: 0.5 s
//             at 300 deg/s and 0.1 s to get there and to stop, first at 1.15 s
// and through the scenes of the same name, by hand, up to 0.6 m/s (depot 0.8)
// and 40 deg/s:
//   table           19 m around the desks in 56 s, then again
//   two_rooms       22 m through both rooms and the door, and back, in 57 s,
//                   then again; where it returns it looks another way
//   twin_corridors  18 m through both in 55 s, and back in the next 55
//   depot           313 m along all aisles and back to the start in 500 s: a
//                   thousand views that differ
SyntheticPath FindSyntheticPath(const std::string& name);

// The names of all paths.
std::vector<std::string> SyntheticPathNames();

// Tours: paths of a camera that is carried through the scenes of the same name
// (synthetic_scene.h) at an even pace with the sway of a hand. They begin
// again when they are over, or come back. As SyntheticPath.
Rigid3d TableTour(double t, double duration);
Rigid3d TwoRoomsTour(double t, double duration);
Rigid3d TwinCorridorsTour(double t, double duration);
Rigid3d DepotTour(double t, double duration);

}  // namespace rgbd_pose
