#include "frontend/frame/depth_warper.h"

#include <algorithm>
#include <cmath>

#include "frontend/frame/depth_resampling.h"

namespace rgbd_pose {
namespace {

constexpr int kFlowBlock = RayGrid::kStep;  // px; with a constant flow
static_assert(kFlowBlock == cv::v_uint16x8::nlanes);

// Smaller differences of displacement (px) within a block, and between two
// iterations, do not matter.
constexpr float kSamePlacePx = 0.5F;

}  // namespace

RayGrid::RayGrid(const Camera& camera, int num_rows, double first_row)
    : columns((camera.width + kStep - 1) / kStep), rows(num_rows) {
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector3d ray = camera.Unproject(
          {column * kStep + (kStep - 1) / 2.0, row * kStep + first_row}, 1.0);
      // If the lens gives no ray, any ray will do.
      rays.push_back(ray.allFinite() ? ray : Eigen::Vector3d::UnitZ());
      pixels.push_back(camera.Project(rays.back()));
    }
  }
}

DepthWarper::DepthWarper(const Camera& camera)
    : camera_(camera),
      blocks_(camera, (camera.height + kFlowBlock - 1) / kFlowBlock,
              (kFlowBlock - 1) / 2.0),
      ranges_(blocks_.rays.size()) {}

const cv::Mat& DepthWarper::Move(const Frame& frame,
                                 const Rigid3d& moved_from_measured) {
  return Move(frame, [&](double) { return moved_from_measured; });
}

const cv::Mat& DepthWarper::Move(const Frame& frame,
                                 const RowMotion& moved_from_measured) {
  frame.depth.copyTo(measured_);
  measured_.setTo(0, measured_ == Frame::kNoDepth);
  moved_.create(measured_.size(), CV_16UC1);
  depth_scale_ = frame.depth_scale;
  FindRanges();
  measured_from_moved_.clear();
  for (int row = 0; row < measured_.rows; ++row) {
    measured_from_moved_.push_back(moved_from_measured(row).Inverse());
  }
  const cv::Rect image(0, 0, camera_.width, camera_.height);
  for (int row = 0; row < blocks_.rows; ++row) {
    // The motion of a block depends on the row where it was measured. Its
    // displacement is about the same as for the block to the left.
    double down = 0.0;
    for (int column = 0; column < blocks_.columns; ++column) {
      const cv::Rect block = cv::Rect(column * kFlowBlock, row * kFlowBlock,
                                      kFlowBlock, kFlowBlock) &
                             image;
      const int middle = block.y + kFlowBlock / 2;
      const int measured_row = std::clamp(
          static_cast<int>(std::lround(middle + down)), 0, measured_.rows - 1);
      const Flow flow =
          FlowAt(static_cast<size_t>(row) * blocks_.columns + column,
                 measured_from_moved_[measured_row]);
      down = flow.turn.y() + kRoomInverseDepth * flow.shift.y();
      const Range range = RangeAround(column, row, flow);
      if (range.min > range.max) {
        moved_(block).setTo(0);
        continue;
      }
      const auto units = static_cast<float>(depth_scale_);
      const float nearest = units / range.min;
      const float farthest = units / range.max;
      const float shift = flow.shift.lpNorm<Eigen::Infinity>();
      if (shift * (nearest - farthest) > kSamePlacePx) {
        MoveEach(block, flow, range);
      } else {
        const float middle = 0.5F * (nearest + farthest);
        MoveTogether(block, flow, flow.turn + middle * flow.shift);
      }
    }
  }
  return moved_;
}

// Columns first, because the compiler can vectorise this loop.
void DepthWarper::FindRanges() {
  for (int row = 0; row < blocks_.rows; ++row) {
    // Subtracting one wraps no depth (0) around to the largest number.
    column_min_.assign(measured_.cols, Frame::kNoDepth);
    column_max_.assign(measured_.cols, 0);
    const int end = std::min((row + 1) * kFlowBlock, measured_.rows);
    for (int v = row * kFlowBlock; v < end; ++v) {
      const auto* raw = measured_.ptr<uint16_t>(v);
      for (int u = 0; u < measured_.cols; ++u) {
        const auto less = static_cast<uint16_t>(raw[u] - 1);
        column_min_[u] = std::min(column_min_[u], less);
        column_max_[u] = std::max(column_max_[u], raw[u]);
      }
    }
    for (int column = 0; column < blocks_.columns; ++column) {
      const int u = column * kFlowBlock;
      const int size = std::min(kFlowBlock, measured_.cols - u);
      const auto low = column_min_.begin() + u;
      const auto high = column_max_.begin() + u;
      const int min = *std::min_element(low, low + size) + 1;
      const uint16_t max = *std::max_element(high, high + size);
      ranges_[static_cast<size_t>(row) * blocks_.columns + column] = {
          static_cast<uint16_t>(max == 0 ? 1 : min), max};
    }
  }
}

DepthWarper::Flow DepthWarper::FlowAt(
    size_t block, const Rigid3d& measured_from_moved) const {
  const Eigen::Vector2d& pixel = blocks_.pixels[block];
  const Eigen::Vector3d turned =
      measured_from_moved.rotation * blocks_.rays[block];
  const Eigen::Vector2d turn = camera_.Project(turned) - pixel;
  const Eigen::Vector2d both =
      camera_.Project(turned +
                      kRoomInverseDepth * measured_from_moved.translation) -
      pixel;
  const Eigen::Vector2d shift = (both - turn) / kRoomInverseDepth;
  return {
      turn.cast<float>(), shift.cast<float>(), static_cast<float>(turned.z()),
      static_cast<float>(measured_from_moved.translation.z() * depth_scale_)};
}

// The range of all blocks that the pixels of a block may come from.
DepthWarper::Range DepthWarper::RangeAround(int column, int row,
                                            const Flow& flow) const {
  constexpr float kMaxInverseDepth = 2.0F;  // 1/m
  const Eigen::Array2f turn = flow.turn;
  const Eigen::Array2f reach = kMaxInverseDepth * flow.shift;
  const Eigen::Array2i first =
      ((turn + reach.min(0.0F)) / kFlowBlock).floor().cast<int>();
  const Eigen::Array2i last =
      ((turn + reach.max(0.0F)) / kFlowBlock).ceil().cast<int>();
  Range range = {1, 0};
  const int end_v = std::min(row + last.y(), blocks_.rows - 1);
  const int end_u = std::min(column + last.x(), blocks_.columns - 1);
  for (int v = std::max(row + first.y(), 0); v <= end_v; ++v) {
    for (int u = std::max(column + first.x(), 0); u <= end_u; ++u) {
      const Range& here = ranges_[static_cast<size_t>(v) * blocks_.columns + u];
      if (here.max == 0) continue;
      range.min = range.max == 0 ? here.min : std::min(range.min, here.min);
      range.max = std::max(range.max, here.max);
    }
  }
  return range;
}

void DepthWarper::MoveTogether(const cv::Rect& block, const Flow& flow,
                               const Eigen::Vector2f& displacement) {
  const float u = displacement.x();
  const float v = displacement.y();
  const int left = cvFloor(u);
  const int above = cvFloor(v);
  const float right = u - static_cast<float>(left);
  const float down = v - static_cast<float>(above);
  const float scale = 1.0F / flow.stretch;
  const float offset = -flow.advance / flow.stretch;
  const cv::Rect source = block + cv::Point(left, above);
  const bool is_inside = block.width == kFlowBlock && source.x >= 0 &&
                         source.y >= 0 && source.br().x < measured_.cols &&
                         source.br().y < measured_.rows;
  for (int y = 0; y < block.height; ++y) {
    auto* to = moved_.ptr<uint16_t>(block.y + y) + block.x;
    if (!is_inside) {
      for (int x = 0; x < block.width; ++x) {
        const float raw =
            SampleDepth(measured_, u + static_cast<float>(block.x + x),
                        v + static_cast<float>(block.y + y));
        to[x] = raw > 0.0F ? EncodeDepth(raw * scale + offset) : 0;
      }
      continue;
    }
    const uint16_t* top = measured_.ptr<uint16_t>(source.y + y) + source.x;
    const uint16_t* bottom =
        measured_.ptr<uint16_t>(source.y + y + 1) + source.x;
    const uint16_t* nearest = (down < 0.5F ? top : bottom) + (right >= 0.5F);
    MoveEight(top, bottom, nearest, {right, down, scale, offset}, to);
  }
}

// The source position of a pixel depends on the surface that it sees, and vice
// versa. The search iterates from the nearest depth around first: a hidden
// surface is found only if nothing hides it.
void DepthWarper::MoveEach(const cv::Rect& block, const Flow& flow,
                           Range range) {
  constexpr int kMaxSteps = 3;
  const auto units = static_cast<float>(depth_scale_);
  const float shift = flow.shift.lpNorm<Eigen::Infinity>();
  for (int v = block.y; v < block.br().y; ++v) {
    auto* to = moved_.ptr<uint16_t>(v);
    for (int u = block.x; u < block.br().x; ++u) {
      to[u] = 0;
      for (const uint16_t start : {range.min, range.max}) {
        float inverse = units / start;
        for (int step = 0; step < kMaxSteps && to[u] == 0; ++step) {
          const float raw = SampleDepth(
              measured_,
              static_cast<float>(u) + flow.turn.x() + inverse * flow.shift.x(),
              static_cast<float>(v) + flow.turn.y() + inverse * flow.shift.y());
          const float moved = (raw - flow.advance) / flow.stretch;
          if (raw <= 0.0F || moved <= 0.0F) break;
          const float last = inverse;
          inverse = units / moved;
          if (shift * std::abs(inverse - last) < kSamePlacePx) {
            to[u] = EncodeDepth(moved);
          }
        }
        if (to[u] != 0) break;
      }
    }
  }
}

}  // namespace rgbd_pose
