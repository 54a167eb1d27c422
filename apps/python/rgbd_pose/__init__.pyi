import os
from typing import (
    Any,
    Dict,
    Iterator,
    List,
    Literal,
    Optional,
    Sequence,
    Tuple,
    Union,
)

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = Union[str, os.PathLike[str]]
_Floats = NDArray[np.float64]
# A TUM text file, or time stamps (N,) and poses (N, 7) or (N, 4, 4).
_Trajectory = Union[_Path, Tuple[ArrayLike, ArrayLike]]

class InputError(ValueError): ...

class EstimateError(RuntimeError):
    estimate: MotionEstimate

def costs() -> List[str]: ...
def losses() -> List[str]: ...
def frontends() -> List[str]: ...
def camera_presets() -> List[str]: ...

class Camera:
    def __init__(
        self,
        fx: float,
        fy: float,
        cx: float,
        cy: float,
        width: int = 640,
        height: int = 480,
        distortion: Sequence[float] = (),
        depth_scale: float = 5000.0,
        color_time_offset: float = 0.0,
        color_readout: float = 0.0,
        depth_time_offset: float = 0.0,
        depth_readout: float = 0.0,
        lens: str = "rational",
    ) -> None: ...
    @staticmethod
    def load(
        path_or_preset: _Path, depth_scale: Optional[float] = None
    ) -> Camera: ...
    @property
    def fx(self) -> float: ...
    @property
    def fy(self) -> float: ...
    @property
    def cx(self) -> float: ...
    @property
    def cy(self) -> float: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def distortion(self) -> Tuple[float, ...]: ...
    @property
    def lens(self) -> str: ...
    @property
    def depth_scale(self) -> float: ...
    @property
    def color_time_offset(self) -> float: ...  # s
    @property
    def color_readout(self) -> float: ...  # s
    @property
    def depth_time_offset(self) -> float: ...  # s
    @property
    def depth_readout(self) -> float: ...  # s
    @property
    def matrix(self) -> _Floats: ...  # (3, 3), px

class MotionEstimate:
    @property
    def status(
        self,
    ) -> Literal[
        "ok",
        "too_few_matches",
        "degenerate",
        "not_converged",
        "inconsistent",
    ]: ...
    @property
    def reason(self) -> str: ...
    @property
    def ok(self) -> bool: ...
    def raise_if_failed(self) -> MotionEstimate: ...
    @property
    def cur_from_prev(self) -> _Floats: ...  # (4, 4), m
    @property
    def covariance(self) -> _Floats: ...  # (6, 6), rad and m
    @property
    def weights(self) -> _Floats: ...  # (N,)
    @property
    def inliers(self) -> NDArray[np.bool_]: ...  # (N,)
    @property
    def residual_norms(self) -> _Floats: ...  # (N,), sigmas
    @property
    def residual_degrees(self) -> NDArray[np.int32]: ...  # (N,)
    @property
    def num_used(self) -> int: ...
    @property
    def num_inliers(self) -> int: ...
    @property
    def num_rejected(self) -> int: ...
    @property
    def sigma(self) -> float: ...
    @property
    def initial_cost(self) -> float: ...
    @property
    def final_cost(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def solve_ms(self) -> float: ...

def estimate_motion(
    points_prev: ArrayLike,
    points_cur: ArrayLike,
    camera: Optional[Camera] = None,
    *,
    initial_guess: Union[str, ArrayLike] = "identity",
    sigma_px: float = 0.5,
    normals_cur: Optional[ArrayLike] = None,
    prior: Optional[Tuple[ArrayLike, ArrayLike]] = None,
    threads: int = 1,
    cost: str = "bidirectional_point",
    loss: str = "tukey",
    scale: str = "fixed",
    robust_schedule: str = "gnc",
    gnc_factor: float = 2.0,
    max_iterations: int = 50,
    min_inlier_share: float = 0.2,
    max_scale: float = 5.0,
    max_standard_deviation: float = 0.5,
    depth_noise: str = "camera",
    assembly: str = "compressed",
) -> MotionEstimate: ...
def estimate_motion_pixels(
    pixels_prev: ArrayLike,
    pixels_cur: ArrayLike,
    camera: Camera,
    *,
    initial_guess: Union[str, ArrayLike] = "identity",
    sigma_px: float = 0.5,
    normals_cur: Optional[ArrayLike] = None,
    prior: Optional[Tuple[ArrayLike, ArrayLike]] = None,
    threads: int = 1,
    cost: str = "bidirectional_point",
    loss: str = "tukey",
    scale: str = "fixed",
    robust_schedule: str = "gnc",
    gnc_factor: float = 2.0,
    max_iterations: int = 50,
    min_inlier_share: float = 0.2,
    max_scale: float = 5.0,
    max_standard_deviation: float = 0.5,
    depth_noise: str = "camera",
    assembly: str = "compressed",
) -> MotionEstimate: ...

_Block = NDArray[np.float64]  # contiguous and writeable

class Factor:
    def evaluate(
        self, blocks: Sequence[ArrayLike]
    ) -> Tuple[_Floats, List[_Floats]]: ...

class AbsolutePoseFactor(Factor):
    def __init__(
        self,
        world_from_body: ArrayLike,
        covariance: ArrayLike,
    ) -> None: ...

class AbsolutePositionFactor(Factor):
    def __init__(
        self,
        in_world: ArrayLike,
        covariance: ArrayLike,
        in_body: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None: ...

class RelativePoseFactor(Factor):
    def __init__(
        self,
        cur_from_ref: ArrayLike,
        covariance: ArrayLike,
    ) -> None: ...

class RelativeRotationFactor(Factor):
    def __init__(
        self,
        cur_from_ref: ArrayLike,
        covariance: ArrayLike,
    ) -> None: ...

class GravityFactor(Factor):
    def __init__(
        self,
        in_body: ArrayLike,
        in_world: ArrayLike,
        sigma: float = 0.01,
    ) -> None: ...

class CommonDirectionFactor(Factor):
    def __init__(
        self,
        in_a: ArrayLike,
        in_b: ArrayLike,
        sigma: float = 0.01,
    ) -> None: ...

class ConstantVelocityFactor(Factor):
    def __init__(
        self,
        seconds: float,
        angular_density: float = 1.0,
        linear_density: float = 1.0,
    ) -> None: ...

class DistanceFactor(Factor):
    def __init__(
        self,
        metres: float,
        sigma: float = 0.01,
        in_a: ArrayLike = (0.0, 0.0, 0.0),
        in_b: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None: ...

class MapPlaneFactor(Factor):
    def __init__(
        self,
        in_body: ArrayLike,
        normal: ArrayLike,
        distance: float,
        sigma: float = 0.01,
    ) -> None: ...

class LandmarkFactor(Factor):
    def __init__(
        self,
        camera: Camera,
        ray: ArrayLike,
        pixel: ArrayLike,
        sigma_px: float = 1.0,
    ) -> None: ...

class Preintegration:
    def __init__(
        self,
        samples: ArrayLike,
        start: float,
        end: float,
        bias: ArrayLike = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        *,
        gyro: float = 3e-4,
        accel: float = 2e-3,
        gyro_walk: float = 2e-5,
        accel_walk: float = 3e-4,
        max_gap: float = 0.05,
    ) -> None: ...
    @property
    def seconds(self) -> float: ...
    @property
    def start_from_end(self) -> _Floats: ...  # (3, 3)
    @property
    def velocity(self) -> _Floats: ...  # (3,), m/s
    @property
    def position(self) -> _Floats: ...  # (3,), m
    @property
    def bias(self) -> _Floats: ...  # (6,), rad/s and m/s^2
    @property
    def by_bias(self) -> _Floats: ...  # (9, 6)
    @property
    def covariance(self) -> _Floats: ...  # (15, 15)

class InertialFactor(Factor):
    def __init__(self, motion: Preintegration, gravity: ArrayLike) -> None: ...

class GyroscopeFactor(Factor):
    def __init__(self, motion: Preintegration) -> None: ...

class PairFactor(Factor):
    def __init__(
        self,
        points_ref: ArrayLike,
        points_cur: ArrayLike,
        camera: Optional[Camera] = None,
        *,
        initial_guess: Optional[ArrayLike] = None,
        cost: str = "bidirectional_point",
        loss: str = "cauchy",
        sigma_px: float = 0.5,
        normals_cur: Optional[ArrayLike] = None,
        depth_noise: str = "camera",
        mounting: str = "constant",
        body_from_ref_cam: Optional[ArrayLike] = None,
        body_from_cur_cam: Optional[ArrayLike] = None,
    ) -> None: ...
    @staticmethod
    def from_pixels(
        pixels_ref: ArrayLike,
        pixels_cur: ArrayLike,
        camera: Camera,
        *,
        initial_guess: Optional[ArrayLike] = None,
        cost: str = "bidirectional_point",
        loss: str = "cauchy",
        sigma_px: float = 0.5,
        normals_cur: Optional[ArrayLike] = None,
        depth_noise: str = "camera",
        mounting: str = "constant",
        body_from_ref_cam: Optional[ArrayLike] = None,
        body_from_cur_cam: Optional[ArrayLike] = None,
    ) -> PairFactor: ...
    def associate(self, cur_from_ref: ArrayLike) -> None: ...

class SolverSummary:
    @property
    def status(self) -> Literal["ok", "not_converged", "failed"]: ...
    @property
    def reason(self) -> str: ...
    @property
    def ok(self) -> bool: ...
    @property
    def initial_cost(self) -> float: ...
    @property
    def final_cost(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def solve_ms(self) -> float: ...

class Problem:
    def __init__(self) -> None: ...
    def add_residual_block(
        self,
        factor: Factor,
        loss: Optional[str],
        blocks: Sequence[_Block],
    ) -> None: ...
    def set_parameter_block_constant(self, block: _Block) -> None: ...
    def set_parameter_block_variable(self, block: _Block) -> None: ...
    def covariance(self, blocks: Sequence[_Block]) -> _Floats: ...  # (N, N)

def solve(problem: Problem, *, max_iterations: int = 100) -> SolverSummary: ...
def pose_block(world_from_body: ArrayLike) -> _Block: ...  # (7,), m
def pose_matrix(pose: ArrayLike) -> _Floats: ...  # (4, 4), m

class RelativePose:
    @property
    def ref(self) -> int: ...
    @property
    def cur(self) -> int: ...
    @property
    def cur_from_ref(self) -> _Floats: ...  # (4, 4), m
    @property
    def covariance(self) -> _Floats: ...  # (6, 6), rad and m

class TrackedFrame:
    @property
    def index(self) -> int: ...
    @property
    def timestamp(self) -> float: ...
    @property
    def status(self) -> Literal["ok", "degraded", "lost"]: ...
    @property
    def reason(self) -> str: ...
    @property
    def world_from_cam(self) -> _Floats: ...  # (4, 4), m
    @property
    def covariance(self) -> Optional[_Floats]: ...  # (6, 6), rad and m
    @property
    def edges(self) -> List[RelativePose]: ...
    @property
    def segment(self) -> int: ...
    @property
    def reference(self) -> int: ...
    @property
    def is_reference(self) -> bool: ...
    @property
    def previous_is_reference(self) -> bool: ...
    @property
    def relocalised(self) -> bool: ...
    @property
    def is_predicted(self) -> bool: ...
    @property
    def tracking_source(self) -> str: ...
    @property
    def matches(self) -> int: ...
    @property
    def inliers(self) -> int: ...
    @property
    def iterations(self) -> int: ...
    @property
    def sigma(self) -> float: ...
    @property
    def track_ms(self) -> float: ...
    @property
    def match_ms(self) -> float: ...
    @property
    def solve_ms(self) -> float: ...
    @property
    def reference_ms(self) -> float: ...
    @property
    def relocalise_ms(self) -> float: ...

class Odometry:
    def __init__(
        self,
        camera: Camera,
        frontend: str = "patch",
        *,
        cost: str = "bidirectional_point",
        loss: str = "tukey",
        scale: str = "fixed",
        robust_schedule: str = "gnc",
        gnc_factor: float = 2.0,
        max_iterations: int = 50,
        min_inlier_share: float = 0.2,
        max_scale: float = 5.0,
        max_standard_deviation: float = 0.5,
        depth_noise: str = "camera",
        assembly: str = "compressed",
        max_features: int = 600,
        feature_noise: float = 1.0,
        min_depth: float = 0.3,
        max_depth: float = 8.0,
        tracker: str = "hybrid",
        direct_cost: str = "photometric+projective_plane",
        direct_loss: str = "tukey",
        direct_points: int = 0,
        direct_levels: int = 4,
        direct_information: float = 0.0,
        min_seen_share: float = 0.15,
        initial_guess: str = "last",
        on_lost: str = "new_segment",
        shutter: str = "camera",
        new_segment_after: float = 1.5,
        guess_sigma_rotation: float = 0.01,
        guess_sigma_translation: float = 0.01,
        min_inliers: int = 15,
        min_inliers_ok: int = 40,
        min_inlier_share_ok: float = 0.35,
        max_sigma_ok: float = 5.0,
        min_reference_share: float = 0.5,
        max_flow_px: float = 60.0,
        prior_sigma_rotation: float = 0.05,
        prior_sigma_translation: float = 0.05,
    ) -> None: ...
    def track(
        self,
        image: NDArray[np.uint8],
        depth: Union[
            NDArray[np.uint16], NDArray[np.float32], NDArray[np.float64]
        ],
        timestamp: Optional[float] = None,
        motion_guess: Optional[ArrayLike] = None,
        depth_delay: float = 0.0,
    ) -> TrackedFrame: ...
    def use_imu(
        self,
        cam_from_imu: ArrayLike,
        delay: float = 0.0,
        has_gyro: bool = True,
    ) -> None: ...
    def add_imu(self, samples: ArrayLike) -> None: ...
    @property
    def trajectory(self) -> Tuple[_Floats, _Floats]: ...  # (N,), (N, 4, 4)
    def save_trajectory(self, path: _Path) -> None: ...
    def view(self, port: int = 0, speed: float = 0.0) -> LivePage: ...

class LivePage:
    @property
    def address(self) -> str: ...
    @property
    def is_stopped(self) -> bool: ...
    def close(self) -> None: ...
    def _repr_html_(self) -> str: ...

class SlamFrame(TrackedFrame):
    @property
    def odom_from_cam(self) -> _Floats: ...  # (4, 4), m
    @property
    def map_from_odom(self) -> _Floats: ...  # (4, 4), m
    @property
    def map_from_cam(self) -> _Floats: ...  # (4, 4), m
    @property
    def segment(self) -> int: ...
    @property
    def pairs(self) -> int: ...
    @property
    def loops(self) -> int: ...
    @property
    def joined(self) -> int: ...
    @property
    def error(self) -> str: ...
    @property
    def map_ms(self) -> float: ...
    @property
    def wait_ms(self) -> float: ...

class Keyframe:
    @property
    def id(self) -> int: ...
    @property
    def segment(self) -> int: ...
    @property
    def timestamp(self) -> float: ...
    @property
    def map_from_cam(self) -> _Floats: ...  # (4, 4), m
    @property
    def covariance(self) -> Optional[_Floats]: ...  # (6, 6), rad and m

class Slam:
    def __init__(
        self,
        camera: Camera,
        frontend: str = "patch",
        *,
        cost: str = "bidirectional_point",
        loss: str = "tukey",
        scale: str = "fixed",
        robust_schedule: str = "gnc",
        gnc_factor: float = 2.0,
        max_iterations: int = 50,
        min_inlier_share: float = 0.2,
        max_scale: float = 5.0,
        max_standard_deviation: float = 0.5,
        depth_noise: str = "camera",
        assembly: str = "compressed",
        max_features: int = 600,
        feature_noise: float = 1.0,
        min_depth: float = 0.3,
        max_depth: float = 8.0,
        tracker: str = "hybrid",
        direct_cost: str = "photometric+projective_plane",
        direct_loss: str = "tukey",
        direct_points: int = 0,
        direct_levels: int = 4,
        direct_information: float = 0.0,
        min_seen_share: float = 0.15,
        initial_guess: str = "last",
        on_lost: str = "new_segment",
        shutter: str = "camera",
        new_segment_after: float = 1.5,
        guess_sigma_rotation: float = 0.01,
        guess_sigma_translation: float = 0.01,
        min_inliers: int = 15,
        min_inliers_ok: int = 40,
        min_inlier_share_ok: float = 0.35,
        max_sigma_ok: float = 5.0,
        min_reference_share: float = 0.5,
        max_flow_px: float = 60.0,
        prior_sigma_rotation: float = 0.05,
        prior_sigma_translation: float = 0.05,
        max_pairs: int = 8,
        min_pair_share: float = 0.4,
        max_loop_candidates: int = 4,
        drift: float = 0.01,
        window: int = 10,
        update_delay: int = 10,
        upright: bool = False,
    ) -> None: ...
    def track(
        self,
        image: NDArray[np.uint8],
        depth: Union[
            NDArray[np.uint16], NDArray[np.float32], NDArray[np.float64]
        ],
        timestamp: Optional[float] = None,
        motion_guess: Optional[ArrayLike] = None,
        depth_delay: float = 0.0,
    ) -> SlamFrame: ...
    def use_imu(
        self,
        cam_from_imu: ArrayLike,
        delay: float = 0.0,
        has_gyro: bool = True,
    ) -> None: ...
    def add_imu(self, samples: ArrayLike) -> None: ...
    def finish(self) -> None: ...
    @property
    def trajectory(self) -> Tuple[_Floats, _Floats]: ...  # (N,), (N, 4, 4)
    def save_trajectory(self, path: _Path) -> None: ...
    def view(self, port: int = 0, speed: float = 0.0) -> LivePage: ...
    def keyframes(self) -> List[Keyframe]: ...
    def edges(self) -> List[RelativePose]: ...
    def save_map(self, folder: _Path) -> None: ...
    def load_map(self, folder: _Path, localise_only: bool = False) -> None: ...

class Frame:
    @property
    def index(self) -> int: ...
    @property
    def timestamp(self) -> float: ...
    @property
    def depth_delay(self) -> float: ...  # of depth, s after the colour image
    @property
    def gray(self) -> NDArray[np.uint8]: ...  # (height, width)
    @property
    def depth(self) -> NDArray[np.uint16]: ...  # (height, width), raw units

class Recording:
    def __init__(
        self,
        path: _Path,
        camera: Union[None, Camera, _Path] = None,
        *,
        source: str = "auto",
        frames: str = "",
        associations: Optional[_Path] = None,
        depth_camera: str = "",
        depth_scale: float = 0.0,
        topics: Sequence[str] = (),
        imu: Optional[_Path] = None,
    ) -> None: ...
    def __len__(self) -> int: ...
    def __getitem__(self, index: int) -> Frame: ...
    def __iter__(self) -> Iterator[Frame]: ...
    @property
    def camera(self) -> Camera: ...
    @property
    def timestamps(self) -> _Floats: ...  # (N,), s
    def ground_truth(self) -> Tuple[_Floats, _Floats]: ...  # (N,), (N, 4, 4)
    def imu(self) -> _Floats: ...  # (N, 7), s, rad/s, m/s^2
    def imu_calibration(self) -> Optional[Dict[str, Any]]: ...

class TumDataset:
    def __init__(
        self,
        folder: _Path,
        camera: Camera,
        associations: Optional[_Path] = None,
    ) -> None: ...
    def __len__(self) -> int: ...
    def __getitem__(self, index: int) -> Frame: ...
    def __iter__(self) -> Iterator[Frame]: ...
    @property
    def camera(self) -> Camera: ...

class Errors:
    @property
    def count(self) -> int: ...
    @property
    def rmse(self) -> float: ...
    @property
    def mean(self) -> float: ...
    @property
    def median(self) -> float: ...
    @property
    def max(self) -> float: ...
    @property
    def values(self) -> _Floats: ...  # (count,), m or rad

class AteResult(Errors):
    @property
    def timestamps(self) -> _Floats: ...  # (count,), s
    @property
    def reference_from_estimated(self) -> _Floats: ...  # (4, 4), m

class RpeResult:
    @property
    def timestamps(self) -> _Floats: ...  # (N,), s
    @property
    def translation(self) -> Errors: ...
    @property
    def rotation(self) -> Errors: ...

def evaluate_ate(
    estimated: _Trajectory,
    reference: _Trajectory,
    max_time_difference: float = 0.02,
) -> AteResult: ...
def evaluate_rpe(
    estimated: _Trajectory,
    reference: _Trajectory,
    delta_seconds: float = 1.0,
    max_time_difference: float = 0.02,
) -> RpeResult: ...
def read_trajectory(path: _Path) -> Tuple[_Floats, _Floats]: ...
def write_trajectory(path: _Path, trajectory: _Trajectory) -> None: ...

class Export:
    @property
    def path(self) -> str: ...
    @property
    def summary(self) -> str: ...
    def __fspath__(self) -> str: ...

def export_formats() -> List[str]: ...
def export_run(
    run: _Path,
    to: str,
    output: Optional[_Path] = None,
    *,
    dataset: Optional[_Path] = None,
    camera: Optional[_Path] = None,
    overwrite: bool = False,
    min_distance: float = 0.05,
    min_angle: float = 3.0,
    undistort: bool = False,
    voxel: float = 0.01,
    max_depth: float = 0.0,
    max_points: int = 200000,
    threads: int = 0,
) -> Export: ...
def export_path(
    recording: Recording,
    trajectory: _Trajectory,
    to: str,
    output: _Path,
    *,
    overwrite: bool = False,
    min_distance: float = 0.05,
    min_angle: float = 3.0,
    undistort: bool = False,
    voxel: float = 0.01,
    max_depth: float = 0.0,
    max_points: int = 200000,
    threads: int = 0,
) -> Export: ...

class CalibratedParameter:
    @property
    def status(self) -> Literal["fixed", "not determined", "determined"]: ...
    @property
    def before(self) -> float: ...
    @property
    def found(self) -> float: ...
    @property
    def sigma(self) -> float: ...

class Calibration:
    @property
    def accepted(self) -> bool: ...
    @property
    def reason(self) -> str: ...
    @property
    def camera(self) -> Camera: ...
    @property
    def parameters(self) -> Dict[str, CalibratedParameter]: ...
    @property
    def depth_noise(self) -> Optional[Tuple[float, float]]: ...  # m, 1/m
    @property
    def summary(self) -> str: ...
    def save_camera(self, path: _Path) -> None: ...
    def save_depth_noise(self, path: _Path) -> None: ...

def calibrate(
    path: _Path,
    camera: Optional[_Path] = None,
    *,
    source: str = "auto",
    frames: str = "",
    associations: Optional[_Path] = None,
    depth_camera: str = "",
    depth_scale: float = 0.0,
    groundtruth: Optional[_Path] = None,
    known_length: str = "",
    fix: str = "",
    max_passes: int = 3,
    max_views: int = 40000,
    threads: int = 0,
) -> Calibration: ...
