"""RGB-D odometry and mapping: the motion of a camera from colour and depth
images.

Poses are named target_from_source: point_in_target = target_from_source @
point_in_source. Lengths are in metres, angles in radians, times in seconds
unless a name says otherwise. Bad input raises InputError, a ValueError.
"""

from ._rgbd_pose import *
from ._rgbd_pose import __version__

__all__ = [
    "AbsolutePoseFactor",
    "AbsolutePositionFactor",
    "AteResult",
    "CalibratedParameter",
    "Calibration",
    "Camera",
    "CommonDirectionFactor",
    "ConstantVelocityFactor",
    "DistanceFactor",
    "Errors",
    "EstimateError",
    "Export",
    "Factor",
    "Frame",
    "GravityFactor",
    "GyroscopeFactor",
    "InertialFactor",
    "InputError",
    "Keyframe",
    "LandmarkFactor",
    "LivePage",
    "MapPlaneFactor",
    "MotionEstimate",
    "Odometry",
    "PairFactor",
    "Preintegration",
    "Problem",
    "Recording",
    "RelativePose",
    "RelativePoseFactor",
    "RelativeRotationFactor",
    "RpeResult",
    "Slam",
    "SlamFrame",
    "SolverSummary",
    "TrackedFrame",
    "calibrate",
    "camera_presets",
    "costs",
    "estimate_motion",
    "estimate_motion_pixels",
    "evaluate_ate",
    "evaluate_rpe",
    "export_formats",
    "export_map",
    "export_path",
    "export_run",
    "frontends",
    "losses",
    "pose_block",
    "pose_matrix",
    "read_trajectory",
    "solve",
    "write_trajectory",
]
