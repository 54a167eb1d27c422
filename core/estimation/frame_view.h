#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/twist.h"

namespace rgbd_pose {

// An image in row-major order owned by someone else.
template <typename Pixel>
struct ImageView {
  const Pixel* data = nullptr;  // null: no image
  int width = 0;
  int height = 0;
  ptrdiff_t stride = 0;  // pixels from one row to the next

  // The arguments are not checked.
  Pixel At(int column, int row) const { return data[row * stride + column]; }
};

// A mask of an image in square cells.
struct CellMask {
  static constexpr int kCellPx = 16;  // side of a cell, px

  int columns = 0;  // number of cells per row
  // Whether each cell is in the mask, row by row. Empty: no cell is.
  std::vector<bool> cells;

  // For a pixel within the image.
  bool Contains(double u, double v) const {
    const size_t at =
        static_cast<int>(v / kCellPx) * columns + static_cast<int>(u / kCellPx);
    return at < cells.size() && cells[at];
  }
};

// The part of an RGB-D frame that costs use, without OpenCV. The images must
// stay unchanged while a cost is bound to them.
struct FrameView {
  // Frames with the same id are identical: costs may cache data. 0: unknown.
  uint64_t id = 0;

  // A gray image and the camera of its pixels.
  struct Level {
    ImageView<uint8_t> gray;  // gray levels
    Camera camera;
  };

  // Full resolution first; each level is about half as large as the last.
  std::vector<Level> levels;

  // Registered to levels[0] and of the same size.
  ImageView<uint16_t> depth;
  double depth_scale = 5000.0;  // raw units per metre
  DepthNoiseModel depth_noise;  // must be filled in

  // Exposure times of rows. Direct costs correct by them where they look points
  // up in a current frame, and where the points of a previous frame are.
  FrameTiming timing;

  // Where the axes that a motion refers to are if they are not those of the
  // camera at the stamp. Only a previous frame may have such axes.
  Rigid3d reference_from_stamp;

  // Moving objects in levels[0], ignored by direct costs; null: none known.
  const CellMask* moving = nullptr;

  // Depth (m) at a pixel of levels[0]; 0 if missing: raw 0 or the maximum.
  double DepthAt(int column, int row) const {
    const uint16_t raw = depth.At(column, row);
    return raw == UINT16_MAX ? 0.0 : raw / depth_scale;
  }
};

}  // namespace rgbd_pose
