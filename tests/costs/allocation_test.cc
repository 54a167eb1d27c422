// Our code does not allocate in steady state, and memory is linear in the
// number of matches. A separate program, since it replaces global operator new.

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "core/estimation/estimator.h"
#include "costs/cost_factory.h"
#include "costs/factors/shutter_pair.h"
#include "costs/matches/bidirectional_point.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/m_estimator.h"
#include "tests/support/shutter_scene.h"

namespace {

std::atomic<long> allocations{0};
std::atomic<long> live_bytes{0};
std::atomic<long> peak_bytes{0};

void* Allocate(std::size_t size, std::size_t alignment) {
  ++allocations;
  const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
  void* memory =
      std::aligned_alloc(alignment, rounded > 0 ? rounded : alignment);
  if (memory == nullptr) throw std::bad_alloc();
  live_bytes += static_cast<long>(malloc_usable_size(memory));
  peak_bytes = std::max(peak_bytes.load(), live_bytes.load());
  return memory;
}

void Free(void* memory) {
  live_bytes -= static_cast<long>(malloc_usable_size(memory));
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) {
  return Allocate(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return Allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { Free(memory); }
void operator delete(void* memory, std::size_t) noexcept { Free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { Free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  Free(memory);
}

namespace rgbd_pose {
namespace {

template <typename Call>
long AllocationsOf(const Call& call) {
  const long before = allocations;
  call();
  return allocations - before;
}

TEST(AllocationTest, TheCounterCounts) {
  EXPECT_GT(AllocationsOf([] { std::vector<double> values(10); }), 0);
}

TEST(AllocationTest, CostsKeepTheirMemory) {
  RandomWorld world(1);
  const Rigid3d truth = world.Motion(0.02, 0.05);
  const Correspondences matches = world.Matches(500, 0.2, truth, /*noise=*/true,
                                                /*missing_depth_share=*/0.2);
  const MotionPrior prior = world.Prior(truth, 0.05);
  const LinearizationPoint origin(truth);
  const MotionVector x = MotionVector::Zero();
  const MotionDerivatives motion = origin.DerivativesAt(x.data());
  for (const std::string& name : CostNames()) {
    const std::unique_ptr<MotionCost> cost = MakeCost(name);
    const auto loss = ParseLoss("tukey").Make(cost->degrees_of_freedom());
    std::vector<double> residuals, norms;
    NormalEquations sum;
    MotionMatrix scatter = MotionMatrix::Zero();
    const auto use = [&] {
      cost->Bind({&matches, &prior});
      cost->Associate(truth);
      cost->Residuals(motion, &residuals);
      cost->SquaredNorms(motion, &norms);
      cost->Linearise(motion, loss.get(), &sum);
      cost->AddScoreOuterProduct(motion, loss.get(), &scatter);
    };
    use();
    ASSERT_GT(cost->matches().size(), 0u) << name;
    EXPECT_EQ(AllocationsOf(use), 0) << name;
  }
}

TEST(AllocationTest, TheCompressedBlockAllocatesNothing) {
  RandomWorld world(2);
  const Correspondences matches = world.Matches(500, 0.2, Rigid3d());
  const std::unique_ptr<MotionCost> cost = MakeCost("bidirectional_point");
  cost->Bind({&matches});
  cost->Associate(Rigid3d());
  const LinearizationPoint origin;
  MotionVector x = MotionVector::Zero();
  ceres::Problem::Options options;
  options.cost_function_ownership = BlockOwnership(Assembly::kCompressed);
  ceres::Problem problem(options);
  cost->AddTo(Assembly::kCompressed, origin, nullptr, x.data(), &problem);
  std::vector<ceres::ResidualBlockId> blocks;
  problem.GetResidualBlocks(&blocks);
  const ceres::CostFunction* block =
      problem.GetCostFunctionForResidualBlock(blocks[0]);
  double r[7], J[42];
  double* jacobians[] = {J};
  const double* parameters[] = {x.data()};
  EXPECT_EQ(AllocationsOf([&] { block->Evaluate(parameters, r, jacobians); }),
            0);
}

TEST(AllocationTest, ThePairOfRollingShuttersAllocatesNothing) {
  using Type = BidirectionalPoint;
  // Without time between rows velocities are not determined.
  for (const double seconds : {0.02, 0.0}) {
    ShutterScene<Type> scene(4);
    std::vector<ShutterMatchFactor<Type>> matches;
    for (int i = 0; i < 100; ++i) matches.push_back(scene.Match(seconds));
    const ShutterPairFactor<Type> pair(
        matches, std::make_unique<ceres::CauchyLoss>(2.0));
    const std::vector<std::vector<double>> x = scene.Blocks();
    const double* parameters[] = {x[0].data(), x[1].data(), x[2].data(),
                                  x[3].data()};
    double r[19], J[4][19 * 7];
    double* jacobians[] = {J[0], J[1], J[2], J[3]};
    EXPECT_EQ(AllocationsOf([&] {
                EXPECT_TRUE(pair.Evaluate(parameters, r, nullptr));
                EXPECT_TRUE(pair.Evaluate(parameters, r, jacobians));
              }),
              0);
  }
}

// Ceres' allocations for a problem of one block do not depend on the number of
// matches. Hence the allocations of Estimate() must not either.
TEST(AllocationTest, EstimateAllocatesTheSameForAnyNumberOfMatches) {
  std::vector<long> counts;
  for (const int count : {100, 20000}) {
    RandomWorld world(3);
    const Rigid3d truth = world.Motion(0.1, 0.1);
    const Correspondences matches =
        world.Matches(count, 0.0, truth, /*noise=*/false);
    EstimatorOptions options;
    options.schedule = RobustSchedule::kDirect;
    Estimator estimator(options,
                        MakeRobustCosts("bidirectional_point", "tukey"));
    MotionEstimate estimate;
    const auto use = [&] { estimator.Estimate({&matches}, truth, &estimate); };
    use();
    use();
    counts.push_back(AllocationsOf(use));
    EXPECT_TRUE(estimate.ok()) << estimate.reason;
  }
  EXPECT_EQ(counts[0], counts[1]);
}

// Peak memory of an estimate in addition to the matches themselves.
long PeakBytesOfEstimate(int count) {
  RandomWorld world(3);
  const Rigid3d truth = world.Motion(0.1, 0.1);
  const Correspondences matches = world.Matches(count, 0.1, truth);
  Estimator estimator(EstimatorOptions(),
                      MakeRobustCosts("bidirectional_point", "tukey"));
  const long before = live_bytes;
  peak_bytes = before;
  const MotionEstimate estimate = estimator.Estimate(matches);
  EXPECT_TRUE(estimate.ok()) << estimate.reason;
  return peak_bytes - before;
}

TEST(AllocationTest, MemoryIsLinearInTheNumberOfMatches) {
  // As docs/benchmarks.md states: 12 columns of 8 bytes, norm, weight and
  // index.
  constexpr long kMaxBytesAMatch = 160;
  // Independent of the number of matches: options, Ceres.
  constexpr long kFixedBytes = 100000;
  for (const int count : {10000, 100000, 1000000}) {
    EXPECT_LE(PeakBytesOfEstimate(count), kFixedBytes + kMaxBytesAMatch * count)
        << count;
    RecordProperty("bytes_" + std::to_string(count),
                   static_cast<int>(PeakBytesOfEstimate(count)));
  }
}

}  // namespace
}  // namespace rgbd_pose
