#include <Eigen/Core>
#include <Eigen/LU>
#include <array>

#include "core/util/vector_lanes.h"
#include "costs/direct/direct_points.h"
#include "costs/direct/lane_image.h"
#include "costs/direct/photometric.h"

namespace rgbd_pose {
namespace {

constexpr double kSigmaGain = 0.3;
constexpr double kSigmaBias = 40.0;
// Two unknowns need no more points than this.
constexpr int kMaxPoints = 2000;
constexpr int kRounds = 3;
// Width of Cauchy's weight: an edge off by a pixel differs by about 10 levels.
constexpr double kWidth = 10.0;

// Gray levels of the same points in both frames.
struct GrayPairs {
  std::array<double, kMaxPoints + kMaxLanes> prev, cur;
  int size = 0;
};

struct SampleKernel {
  template <int W>
  [[gnu::always_inline]] static void Run(const DirectInput& input,
                                         const PackedColumns& points,
                                         GrayPairs* pairs) {
    using D = typename Lanes<W>::Type;
    // Groups of kMaxLanes points, whatever W: the same points on all machines.
    const int step = (points.size / kMaxPoints + 1) * kMaxLanes;
    for (int group = 0; group < points.size; group += step) {
      for (int i = group; i < group + kMaxLanes && i < points.size; i += W) {
        D point[Photometric::kPointColumns];
        points.Load(i, point);
        ProjectedPoint<D> place;
        Photometric::Locate(input, point, &place);
        for (int lane = 0; lane < W && i + lane < points.size; ++lane) {
          float reads[Photometric::kSamples];
          if (!(place.z[lane] > DirectInput::kMinDepth) ||
              !Photometric::Read(input, place.u[lane], place.v[lane], 1,
                                 reads)) {
            continue;
          }
          ImageSample<float> sample;
          Interpolate(reads[0], reads[1], reads + 2, &sample);
          pairs->prev[pairs->size] = point[4][lane];
          pairs->cur[pairs->size++] = sample.value;
        }
      }
    }
  }
};

}  // namespace

void EstimateBrightness(const PackedColumns& points, DirectInput* input) {
  GrayPairs pairs;
  RunVectorised<SampleKernel>(*input, points, &pairs);
  constexpr double kNoise2 = kWidth * kWidth;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d H = Eigen::Vector2d(kNoise2 / (kSigmaGain * kSigmaGain),
                                        kNoise2 / (kSigmaBias * kSigmaBias))
                            .asDiagonal();
    Eigen::Vector2d b(H(0, 0), 0.0);  // for gain 1 and bias 0
    for (int i = 0; i < pairs.size; ++i) {
      const double x = pairs.prev[i], y = pairs.cur[i];
      const double r = y - input->gain * x - input->bias;
      const double weight = kNoise2 / (kNoise2 + r * r);
      H(0, 0) += weight * x * x;
      H(0, 1) += weight * x;
      H(1, 1) += weight;
      b[0] += weight * x * y;
      b[1] += weight * y;
    }
    H(1, 0) = H(0, 1);
    const Eigen::Vector2d fit = H.inverse() * b;
    input->gain = fit[0];
    input->bias = fit[1];
  }
}

}  // namespace rgbd_pose
