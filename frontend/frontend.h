#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/camera.h"
#include "core/correspondences.h"
#include "core/depth_noise.h"
#include "core/rigid3.h"
#include "frontend/frame.h"

namespace rgbd_pose {

// What all frontends share.
struct FrontendOptions {
  Camera camera;

  // How uncertain a measured depth is.
  const DepthNoiseModel* depth_noise = FindDepthNoiseModel("khoshelham");

  // The number of features wanted in a reference frame.
  int max_features = 400;

  // Depths beyond these limits (m) are not used.
  double min_depth = 0.3;
  double max_depth = 8.0;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// Finds matches between a reference frame and the frames that follow it. One
// object serves one sequence at a time.
class Frontend {
 public:
  virtual ~Frontend() = default;

  virtual std::string_view name() const = 0;

  // Takes a frame as the reference and returns how many of its features have
  // a depth.
  virtual int SetReference(const Frame& frame) = 0;

  // Fills `matches` (emptied first) with the reference's features (prev) found
  // in `frame` (cur). The guess says where to look for them first.
  virtual void Match(const Frame& frame, const Rigid3d& cur_from_ref_guess,
                     Correspondences* matches) = 0;
};

// The names of all frontends.
std::vector<std::string> FrontendNames();

// The frontend of that name. Throws InputError listing the names there are, or
// saying what is wrong with the options.
std::unique_ptr<Frontend> MakeFrontend(std::string_view name,
                                       const FrontendOptions& options);

}  // namespace rgbd_pose
