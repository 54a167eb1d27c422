"""A problem of your own, solved with factors, as in own_problem.cc."""
import numpy as np
import rgbd_pose

# A camera goes round a square and comes back. A quarter of it, as measured:
# 1 degree too much, 1 m ahead.
c, s = np.cos(np.radians(91.0)), np.sin(np.radians(91.0))
next_from_this = np.array(
    [[c, 0, s, -s], [0, 1, 0, 0], [-s, 0, c, -c], [0, 0, 0, 1]]
)
covariance = np.diag([1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-6])  # rad^2, m^2
motion = rgbd_pose.RelativePoseFactor(next_from_this, covariance)

poses = np.empty((4, 7))  # each row is a block: qx qy qz qw x y z
world_from_cam = np.eye(4)
for pose in poses:
    pose[:] = rgbd_pose.pose_block(world_from_cam)
    world_from_cam = world_from_cam @ np.linalg.inv(next_from_this)

problem = rgbd_pose.Problem()
for i in range(4):
    problem.add_residual_block(motion, None, [poses[i], poses[(i + 1) % 4]])
problem.set_parameter_block_constant(poses[0])
summary = rgbd_pose.solve(problem)
quarter = 2 * np.degrees(np.arccos(poses[1, 3]))
print(f"{summary.status}, {quarter:.2f} degrees")  # prints ok, 90.00 degrees
covariance = problem.covariance([poses[2]])  # (6, 6), of [omega p]
print(np.sqrt(np.diag(covariance)))          # standard deviations, rad, m
