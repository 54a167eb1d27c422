#pragma once

#include <Eigen/Core>

// Eigen aligns its vectors, and the memory that it asks for, by the instruction
// set of the compiler's flags: -march=native or -mavx2 of one part of a program
// and not of another leave it with two sorts of vectors, and it crashes.
// RGBD_POSE_EIGEN_ALIGN is what the libraries were built with (bytes), a usage
// requirement of rgbd_pose::core.
#ifdef RGBD_POSE_EIGEN_ALIGN
static_assert(EIGEN_MAX_ALIGN_BYTES == RGBD_POSE_EIGEN_ALIGN &&
                  EIGEN_MAX_STATIC_ALIGN_BYTES == RGBD_POSE_EIGEN_ALIGN,
              "rgbd_pose was built with another alignment of Eigen's vectors "
              "(RGBD_POSE_EIGEN_ALIGN): leave out -march=native, -mavx and the "
              "like, or add -DEIGEN_MAX_ALIGN_BYTES=16 to all that uses Eigen, "
              "or build rgbd_pose with the same flags");
#endif
