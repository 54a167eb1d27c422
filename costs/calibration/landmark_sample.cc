#include "costs/calibration/landmark_sample.h"

namespace rgbd_pose {

std::shared_ptr<const CalibrationModel> SampleModel(FactorSampler* random) {
  auto model = std::make_shared<CalibrationModel>();
  const double lens = random->Uniform(0.0, 3.0);
  if (lens < 1.0) {
    model->camera.k4 = random->Uniform(0.05, 0.1);
    model->camera.k5 = random->Uniform(-0.1, 0.1);
    model->camera.k6 = random->Uniform(-0.1, 0.1);
  } else if (lens < 2.0) {
    model->camera.SetDistortion(LensModel::kEquidistant,
                                std::vector<double>(4, 0.0));
  }
  model->origin.start << 525.0, 520.0, 319.5, 239.5, 0.1, -0.1, 0.05, 0.01,
      0.003, -0.002, 0.01, 0.01, 0.02, 0.03, 0.01, 0.02, -0.01, 0.01, 0.02,
      0.01, 1.02;
  for (int k = 0; k < kCalibrationSize; ++k) {
    model->origin.width[k] = kCalibrationParameters[k].prior *
                             (k <= kFy ? model->origin.start[k] : 1.0) *
                             random->Uniform(0.5, 2.0);
  }
  return model;
}

LandmarkData SampleLandmark(FactorSampler* random) {
  LandmarkData data;
  data.anchor_u = random->Uniform(20.0, 620.0);
  data.anchor_v = random->Uniform(20.0, 460.0);
  data.u = random->Uniform(20.0, 620.0);
  data.v = random->Uniform(20.0, 460.0);
  data.inverse_sigma_px = random->Uniform(1.0, 4.0);
  data.depth.value = random->Uniform(0.2, 1.0);
  data.depth.inverse_sigma = random->Uniform(100.0, 1000.0);
  data.depth.plane = random->Vector<3>(0.5) + Eigen::Vector3d::UnitZ();
  data.depth.ray << random->Vector<2>(0.5), 1.0;
  for (RowMotion* motion : {&data.anchor_motion, &data.motion}) {
    motion->twist = {random->Vector<3>(1.0), random->Vector<3>(1.0)};
    motion->row = random->Uniform(-0.5, 0.5);
  }
  data.depth.undone_rotation = random->Vector<3>(0.02);
  data.depth.undone_translation = random->Vector<3>(0.02);
  return data;
}

std::vector<double> SampledAnchor() {
  return {0.1, 0.2, 0.3, 0.9, 0.4, -0.2, 0.1};
}

std::vector<double> SampledView() {
  return {0.2, 0.2, 0.2, 0.9, 0.1, -0.1, 0.3};
}

std::vector<double> SampledInverseDepth() { return {0.5}; }

std::vector<double> SampledY() {
  return std::vector<double>(kCalibrationSize, 0.0);
}

}  // namespace rgbd_pose
