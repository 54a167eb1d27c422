#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/factors/sampler.h"
#include "core/geometry/camera.h"
#include "costs/calibration/calibration_parameters.h"
#include "costs/calibration/landmark_data.h"

// Random measurements at which the Jacobians of calibration factors are
// checked, and states at which these can be evaluated.

namespace rgbd_pose {

// A camera with a plumb-bob, rational or equidistant lens.
std::shared_ptr<const CalibrationModel> SampleModel(FactorSampler* random);

// A landmark as its anchor and a view may have measured it.
LandmarkData SampleLandmark(FactorSampler* random);

// The blocks of a state: two cameras that look the same way, a landmark 2 m
// away, and all parameters near their origin.
std::vector<double> SampledAnchor();
std::vector<double> SampledView();
std::vector<double> SampledInverseDepth();
std::vector<double> SampledY();

}  // namespace rgbd_pose
