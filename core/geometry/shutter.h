#pragma once

namespace rgbd_pose {

// Exposure times of the rows of an image: row r of H is exposed at
//
//   stamp + offset + readout ((r + 1/2) / H - 1/2)
//
// in seconds. The readout time is the time from the first row to the last;
// negative if the last row comes first, 0 for a global shutter.
struct Shutter {
  double offset = 0.0;   // of the middle row, relative to the timestamp, s
  double readout = 0.0;  // s

  // Whether the values were given. If not, the uncertainty of motions is
  // increased by the effect of a usual shutter.
  bool is_known = false;

  // Whether all rows are exposed at the timestamp.
  bool IsGlobal() const { return offset == 0.0 && readout == 0.0; }

  // Exposure time of a row (px, may be fractional) after the timestamp, s.
  double RowTime(double row, int height) const {
    return offset + readout * ((row + 0.5) / height - 0.5);
  }
};

}  // namespace rgbd_pose
