#pragma once

#include <pybind11/pybind11.h>

namespace rgbd_pose {

// Each function adds its classes and functions to the module.
void BindCalibration(pybind11::module_* module);
void BindCamera(pybind11::module_* module);
void BindEstimate(pybind11::module_* module);
void BindPreintegration(pybind11::module_* module);
void BindFactors(pybind11::module_* module);     // after BindPreintegration
void BindPairFactor(pybind11::module_* module);  // by BindFactors
void BindProblem(pybind11::module_* module);     // after BindFactors
void BindRecording(pybind11::module_* module);
void BindOdometry(pybind11::module_* module);
void BindSlam(pybind11::module_* module);
void BindEvaluation(pybind11::module_* module);
void BindExport(pybind11::module_* module);  // after BindRecording

}  // namespace rgbd_pose
