#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/estimation/motion_cost.h"
#include "core/util/input_error.h"
#include "core/util/vector_lanes.h"
#include "costs/assembly/packed_cost.h"
#include "costs/direct/direct_points.h"
#include "costs/direct/selected_points.h"

namespace rgbd_pose {

// Fills the columns of all visible points. Arithmetic handles several points at
// a time, reading images and rejecting points goes one by one. Separate passes
// over tiles of points keep the two from waiting for each other.
template <typename Residual>
struct LookUpKernel {
  template <int W>
  [[gnu::always_inline]] static void Run(const DirectInput& input,
                                         const PackedColumns& points,
                                         PackedColumns* seen) {
    Tile tile;
    std::memset(tile.samples, 0, sizeof(tile.samples));
    seen->size = 0;
    for (int begin = 0; begin < points.size; begin += kTile) {
      const int size = std::min(kTile, points.size - begin);
      for (int i = 0; i < size; i += W)
        Locate<W>(input, points, begin, i, &tile);
      Read(input, size, &tile);
      for (int i = 0; i < size; i += W)
        LookUp<W>(input, points, begin, i, &tile);
      Append(tile, size, seen);
    }
  }

 private:
  static constexpr int kTile = 256;

  // A tile of points between the passes.
  struct Tile {
    alignas(64) double u[kTile], v[kTile], z[kTile];
    alignas(64) float samples[Residual::kSamples][kTile];
    alignas(64) double columns[Residual::kColumns][kTile];
    alignas(64) double rejection[kTile];
    bool is_read[kTile];
  };

  template <int W>
  [[gnu::always_inline]] static void Locate(const DirectInput& input,
                                            const PackedColumns& points,
                                            int begin, int i, Tile* tile) {
    using D = typename Lanes<W>::Type;
    D point[Residual::kPointColumns];
    points.Load(begin + i, point);
    ProjectedPoint<D> place;
    Residual::Locate(input, point, &place);
    std::memcpy(&tile->u[i], &place.u, sizeof(D));
    std::memcpy(&tile->v[i], &place.v, sizeof(D));
    std::memcpy(&tile->z[i], &place.z, sizeof(D));
  }

  // Points that are not read keep valid numbers from an earlier point. The mask
  // comes last: it is for pixels within the image only.
  [[gnu::always_inline]] static void Read(const DirectInput& input, int size,
                                          Tile* tile) {
    for (int i = 0; i < size; ++i) {
      tile->is_read[i] =
          tile->z[i] > DirectInput::kMinDepth &&
          Residual::Read(input, tile->u[i], tile->v[i], kTile,
                         &tile->samples[0][i]) &&
          !(input.moving != nullptr &&
            input.moving->Contains(input.px_to_full * tile->u[i],
                                   input.px_to_full * tile->v[i]));
    }
  }

  template <int W>
  [[gnu::always_inline]] static void LookUp(const DirectInput& input,
                                            const PackedColumns& points,
                                            int begin, int i, Tile* tile) {
    using D = typename Lanes<W>::Type;
    typedef float Floats __attribute__((vector_size(sizeof(D) / 2)));
    D point[Residual::kPointColumns], samples[Residual::kSamples];
    D columns[Residual::kColumns], rejection;
    points.Load(begin + i, point);
    for (int k = 0; k < Residual::kSamples; ++k) {
      Floats floats;
      std::memcpy(&floats, &tile->samples[k][i], sizeof(Floats));
      samples[k] = __builtin_convertvector(floats, D);
    }
    Residual::LookUp(input, point, samples, columns, &rejection);
    for (int k = 0; k < Residual::kColumns; ++k) {
      std::memcpy(&tile->columns[k][i], &columns[k], sizeof(D));
    }
    std::memcpy(&tile->rejection[i], &rejection, sizeof(D));
  }

  [[gnu::always_inline]] static void Append(const Tile& tile, int size,
                                            PackedColumns* seen) {
    int kept[kTile + 1];
    int count = 0;
    for (int i = 0; i < size; ++i) {
      kept[count] = i;
      count += tile.is_read[i] && tile.rejection[i] < 1.0;
    }
    for (int k = 0; k < Residual::kColumns; ++k) {
      double* const to = &seen->values[k * seen->stride + seen->size];
      for (int i = 0; i < count; ++i) to[i] = tile.columns[k][kept[i]];
    }
    seen->size += count;
  }
};

// Detects a residual type's optional NoiseRow.
template <typename Residual>
using NoiseRowOf = decltype(&Residual::NoiseRow);

// The MotionCost of a direct residual type. Its points are selected once per
// previous frame and looked up in the current frame after every step. A
// residual type derives from DirectResidual, which has defaults for other
// constants, and defines
//
//   kPointColumns, kSamples
//   Points(frame, level, options, points)    selects points of a previous frame
//   Locate(input, point, place)              projects; on vectors of doubles
//   Read(input, u, v, stride, samples)       reads kSamples numbers there
//
// (or derives from Surface, which has these), and
//
//   kName, kColumns
//   LookUp(input, point, samples, columns, rejection)
//                                            on vectors of doubles; a point is
//                                            kept if its rejection is below 1
//   Residual(motion pose, columns, r)        for any scalars
//   Jacobian(motion derivatives, columns, r, J)
//                                            optional; default: Ceres' Jets
//   NoiseRow(input, axis, columns)           optional: turns a row into one of
//                                            pure slope noise along an image
//                                            axis (0: u, 1: v)
template <typename Type>
class DirectCostOf final : public PackedCost<Type> {
  using Residual = typename PackedCost<Type>::Residual;

 public:
  // The options must be valid (see Check).
  explicit DirectCostOf(const DirectOptions& options)
      : options_(options), points_(options.num_levels) {}

  AssociationPolicy association() const override {
    return AssociationPolicy::kEveryStep;
  }
  int scale_group() const override { return Residual::kScaleGroup; }
  double information_factor() const override {
    return options_.information_factor > 0.0 ? options_.information_factor
                                             : Residual::kInformation;
  }

  int num_levels() const override { return options_.num_levels; }
  void SetLevel(int level) override { level_ = level; }

  // The points of previous frames with a nonzero id are kept for further pairs.
  void Bind(const FramePair& pair) override {
    this->SetThreads(pair.threads);
    level_ = 0;
    input_ = DirectInput();
    static const FrameView none{};
    const bool has_images = pair.prev != nullptr && pair.cur != nullptr;
    prev_ = has_images ? pair.prev : nullptr;
    input_.cur = pair.cur != nullptr ? pair.cur : &none;
    points_.Begin(has_images ? pair.prev->id : 0);
    if (!has_images) return;
    input_.moving = pair.cur->moving;
    input_.lens = pair.cur->levels[0].camera.MakeLens();
    input_.moves_color = !pair.cur->timing.color.IsGlobal();
    input_.moves_depth = !pair.cur->timing.depth.IsGlobal();
    RequireSound(pair.prev->depth_noise.Check(),
                 "direct cost: the view's depth_noise: ");
  }

  void Associate(const Rigid3d& cur_from_prev) override {
    MoveTo(cur_from_prev);
    if constexpr (Residual::kSeesBrightness) {
      EstimateBrightness(PointsOf(level_), &input_);
    }
    LookUp();
  }

  void Reassociate(const Rigid3d& cur_from_prev) override {
    if (MoveTo(cur_from_prev)) LookUp();
  }

  void AddSpuriousInformation(const MotionDerivatives& motion,
                              MotionMatrix* hessian) const override {
    if constexpr (kHas<NoiseRowOf, Residual>) {
      const PackedColumns& rows = this->columns();
      noise_.Clear(Residual::kColumns,
                   (rows.size + kSpuriousStep - 1) / kSpuriousStep * 2);
      typename PackedCost<Type>::Block row;
      for (int i = 0; i < rows.size; i += kSpuriousStep) {
        for (int axis = 0; axis < 2; ++axis) {
          rows.Read(i, &row);
          Residual::NoiseRow(input_, axis, row.data());
          noise_.Append(row);
        }
      }
      noise_.Pad();
      NormalEquations sum;
      constexpr const ceres::LossFunction* kNoLoss = nullptr;
      RunVectorised<packed::LineariseKernel<Residual>>(motion, noise_, kNoLoss,
                                                       0, noise_.size, &sum);
      *hessian += kSpuriousStep * sum.hessian;
    }
  }

 private:
  // One in this many points represents all of them in the spurious information.
  static constexpr int kSpuriousStep = 8;

  // Images with fewer levels repeat their coarsest one. Of no images it is 0.
  int ImageLevel(const FrameView& frame, int level) const {
    const int coarsest = static_cast<int>(frame.levels.size()) - 1;
    return std::max(0, std::min(options_.finest_level + level, coarsest));
  }

  // Returns false if the level and, up to rounding, the motion are unchanged.
  bool MoveTo(const Rigid3d& cur_from_prev) {
    constexpr double kRounding = 1e-12;
    const Eigen::Matrix3d R = cur_from_prev.rotation.toRotationMatrix();
    const Eigen::Vector3d& t = cur_from_prev.translation;
    const int level = ImageLevel(*input_.cur, level_);
    const bool is_there = level == input_.level &&
                          (R - input_.R).cwiseAbs().maxCoeff() <= kRounding &&
                          (t - input_.t).cwiseAbs().maxCoeff() <= kRounding;
    input_.level = level;
    if constexpr (Residual::kSeesBrightness) input_.px_to_full = 1 << level;
    input_.R = R;
    input_.t = t;
    return !is_there;
  }

  const PackedColumns& PointsOf(int level) {
    return points_.At(level, [&](PackedColumns* points) {
      points->size = 0;
      if (prev_ == nullptr) return;
      // Coarser levels only lead to the finest one.
      constexpr int kMaxCoarsePoints = 1000;
      DirectOptions selection = options_;
      int& count = selection.max_points;
      if (count == 0) count = Residual::kMaxPoints;
      if (level > 0) count = std::min(count, kMaxCoarsePoints);
      Residual::Points(*prev_, ImageLevel(*prev_, level), selection, points);
    });
  }

  void LookUp() {
    const PackedColumns& points = PointsOf(level_);
    PackedColumns* const seen = this->BeginBlocks(points.size);
    RunVectorised<LookUpKernel<Residual>>(input_, points, seen);
    this->EndBlocks();
  }

  DirectOptions options_;
  const FrameView* prev_ = nullptr;  // of the bound pair; null: no images
  SelectedPoints points_;            // of previous frames
  DirectInput input_;
  int level_ = 0;
  mutable PackedColumns noise_;  // see AddSpuriousInformation
};

}  // namespace rgbd_pose
