"""Maps a sequence, keeps the map, and finds the camera in it again."""
import numpy as np
import rgbd_pose

camera = rgbd_pose.Camera.load("sequence/camera.yaml")
frames = list(rgbd_pose.Recording("sequence"))

slam = rgbd_pose.Slam(camera)
for frame in frames:
    tracked = slam.track(
        frame.gray, frame.depth, frame.timestamp, depth_delay=frame.depth_delay
    )
    if tracked.loops:
        print(tracked.index, "closes", tracked.loops, "loops")
print(tracked.odom_from_cam[:3, 3])  # moves on smoothly
print(tracked.map_from_cam[:3, 3])   # the same pose, corrected
slam.finish()
slam.save_trajectory("trajectory.txt")
for keyframe in slam.keyframes():
    if keyframe.covariance is not None:
        print(keyframe.id, np.sqrt(np.diag(keyframe.covariance)))  # rad, m
slam.save_map("map")

again = rgbd_pose.Slam(camera)
again.load_map("map", localise_only=True)
for frame in frames:
    found = again.track(frame.gray, frame.depth, frame.timestamp,
                        depth_delay=frame.depth_delay)
again.finish()
stamps, map_from_cam = again.trajectory
print(np.round(map_from_cam[0, :3, 3], 2))  # prints [0. 0. 0.]
