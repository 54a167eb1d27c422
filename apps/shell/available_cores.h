#pragma once

namespace rgbd_pose {

// How many processor cores this process may use, at least 1.
int AvailableCores();

// What the flag --threads of a program comes to: 0 is one a core. Throws
// InputError for what is no number of threads.
int NumThreads(int flag);

}  // namespace rgbd_pose
