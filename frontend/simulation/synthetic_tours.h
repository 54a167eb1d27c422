#pragma once

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Tours: paths of a camera that is carried through the scenes of the same name
// (synthetic_buildings.h) at an even pace with the sway of a hand. They begin
// again when they are over, or come back. As SyntheticPath.
Rigid3d TableTour(double t, double duration);
Rigid3d TwoRoomsTour(double t, double duration);
Rigid3d TwinCorridorsTour(double t, double duration);
Rigid3d DepotTour(double t, double duration);

}  // namespace rgbd_pose
