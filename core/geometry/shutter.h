#pragma once

namespace rgbd_pose {

// When the rows of an image are exposed: a row r of H at
//
//   stamp + offset + readout ((r + 1/2) / H - 1/2)
//
// in seconds. The readout is the time from the first row to the last, negative
// where the last comes first, 0 for a global shutter.
struct Shutter {
  double offset = 0.0;   // of the middle row after the stamp, s
  double readout = 0.0;  // s

  // Whether somebody says so. Of a camera of which nobody does, motions are as
  // uncertain as a usual shutter makes them.
  bool is_known = false;

  // Whether all rows are exposed at the stamp.
  bool IsGlobal() const { return offset == 0.0 && readout == 0.0; }

  // How long after the stamp a row (px, may lie between two) is exposed, s.
  double RowTime(double row, int height) const {
    return offset + readout * ((row + 0.5) / height - 0.5);
  }
};

}  // namespace rgbd_pose
