#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {

// An image that somebody else owns, row by row.
template <typename Pixel>
struct ImageView {
  const Pixel* data = nullptr;  // null: none
  int width = 0;
  int height = 0;
  ptrdiff_t stride = 0;  // pixels from one row to the next

  // Neither is checked.
  Pixel At(int column, int row) const { return data[row * stride + column]; }
};

// Parts of an image, in square cells.
struct CellMask {
  static constexpr int kCellPx = 16;  // side of a cell, px

  int columns = 0;  // of cells
  // Whether each is in the mask, row by row; empty: none is.
  std::vector<bool> cells;

  // Of a pixel within the image.
  bool Contains(double u, double v) const {
    const size_t at =
        static_cast<int>(v / kCellPx) * columns + static_cast<int>(u / kCellPx);
    return at < cells.size() && cells[at];
  }
};

// What a cost may see of an RGB-D frame, without OpenCV. The images must stay
// as they are for as long as a cost is bound to them.
struct FrameView {
  // Frames with the same id are the same, so that a cost may keep what it has
  // made of one; 0: not known.
  uint64_t id = 0;

  // A gray image and the camera of its pixels.
  struct Level {
    ImageView<uint8_t> gray;  // gray levels
    Camera camera;
  };

  // From the full resolution on, each about half as large as the one before.
  std::vector<Level> levels;

  // Registered to levels[0] and of its size.
  ImageView<uint16_t> depth;
  double depth_scale = 5000.0;  // raw units per metre
  DepthNoiseModel depth_noise;  // has to be filled in

  // When rows were exposed. Direct costs move the look-ups in a current frame
  // by it; a previous one has to be of one moment (FrameRectifier).
  FrameTiming timing;

  // What moves by itself in levels[0]: direct costs do not look there. Null:
  // nothing is known to.
  const CellMask* moving = nullptr;

  // Metres at a whole pixel of levels[0]; 0 where there is none: sensors mark
  // that by 0 or by the largest value.
  double DepthAt(int column, int row) const {
    const uint16_t raw = depth.At(column, row);
    return raw == UINT16_MAX ? 0.0 : raw / depth_scale;
  }
};

}  // namespace rgbd_pose
