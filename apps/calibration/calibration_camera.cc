#include <Eigen/Geometry>

#include "apps/calibration/calibration.h"

namespace rgbd_pose {

CalibrationVector ThetaOf(const Camera& camera) {
  CalibrationVector theta = CalibrationVector::Zero();
  theta[kFx] = camera.fx;
  theta[kFy] = camera.fy;
  theta[kCx] = camera.cx;
  theta[kCy] = camera.cy;
  theta[kK1] = camera.k1;
  theta[kK2] = camera.k2;
  theta[kDepthFactor] = 1.0;
  return theta;
}

RgbdCamera ApplyCalibration(const RgbdCamera& first,
                            const CalibrationVector& theta) {
  RgbdCamera changed = first;
  Camera& camera = changed.camera;
  camera.fx = theta[kFx];
  camera.fy = theta[kFy];
  camera.cx = theta[kCx];
  camera.cy = theta[kCy];
  camera.k1 = theta[kK1];
  camera.k2 = theta[kK2];
  changed.depth_scale = first.depth_scale / theta[kDepthFactor];
  changed.depth_correction.inverse_depth_offset =
      first.depth_correction.inverse_depth_offset / theta[kDepthFactor] +
      theta[kInverseDepth];
  changed.depth_shutter.offset += theta[kDepthTime];
  changed.depth_shutter.readout += theta[kDepthReadout];
  changed.color_shutter.readout += theta[kColorReadout];
  changed.depth_correction.depth_from_color =
      first.depth_correction.depth_from_color *
      Rigid3d::FromRotationVector(theta.segment<3>(kRotationX),
                                  theta.segment<3>(kTranslationX));
  return changed;
}

CalibrationVector ThetaBetween(const RgbdCamera& first,
                               const RgbdCamera& changed) {
  CalibrationVector theta = ThetaOf(changed.camera);
  theta[kDepthFactor] = first.depth_scale / changed.depth_scale;
  const DepthCorrection& before = first.depth_correction;
  const DepthCorrection& after = changed.depth_correction;
  theta[kInverseDepth] = after.inverse_depth_offset -
                         before.inverse_depth_offset / theta[kDepthFactor];
  theta[kDepthTime] = changed.depth_shutter.offset - first.depth_shutter.offset;
  theta[kDepthReadout] =
      changed.depth_shutter.readout - first.depth_shutter.readout;
  theta[kColorReadout] =
      changed.color_shutter.readout - first.color_shutter.readout;
  const Rigid3d moved =
      before.depth_from_color.Inverse() * after.depth_from_color;
  theta.segment<3>(kRotationX) = RotationVector(moved.rotation);
  theta.segment<3>(kTranslationX) = moved.translation;
  return theta;
}

}  // namespace rgbd_pose
