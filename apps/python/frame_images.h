#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <opencv2/core.hpp>

#include "apps/python/arrays.h"
#include "core/geometry/camera.h"
#include "frontend/image/frame.h"

namespace rgbd_pose {

// A frame with copies of the images that Python gave (see Odometry.track):
// frontends keep the image of a reference, and cameras write the next image
// into the same memory. Throws InputError for images of a wrong shape or type.
Frame FrameFromArrays(const pybind11::object& image,
                      const pybind11::object& depth, const RgbdCamera& camera);

// An image that an object holds, seen as an array that keeps it alive; no copy.
template <typename T>
pybind11::array ArrayOfImage(const cv::Mat& image, pybind11::handle owner) {
  return ReadOnly(
      pybind11::array(pybind11::dtype::of<T>(), {image.rows, image.cols},
                      {image.step[0], image.step[1]}, image.data, owner));
}

}  // namespace rgbd_pose
