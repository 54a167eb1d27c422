"""RGB-D odometry and mapping: the motion of a camera from colour and depth
images.

Poses are named target_from_source: point_in_target = target_from_source @
point_in_source. Lengths are in metres, angles in radians, times in seconds
unless a name says otherwise. Bad input raises InputError, a ValueError.
"""

from ._rgbd_pose import *
from ._rgbd_pose import __version__

__all__ = [
    "AteResult",
    "CalibratedParameter",
    "Calibration",
    "Camera",
    "RelativePose",
    "Errors",
    "EstimateError",
    "Export",
    "Frame",
    "InputError",
    "Keyframe",
    "LivePage",
    "MotionEstimate",
    "Odometry",
    "Recording",
    "RpeResult",
    "Slam",
    "SlamFrame",
    "TrackedFrame",
    "TumDataset",
    "calibrate",
    "camera_presets",
    "costs",
    "estimate_motion",
    "estimate_motion_pixels",
    "evaluate_ate",
    "evaluate_rpe",
    "export_formats",
    "export_path",
    "export_run",
    "frontends",
    "losses",
    "read_trajectory",
    "write_trajectory",
]
