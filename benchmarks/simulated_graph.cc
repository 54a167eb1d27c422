#include "benchmarks/simulated_graph.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/estimation/estimator.h"
#include "core/evaluation/alignment.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

constexpr double kStep = 0.44;             // m along the wall per keyframe
constexpr double kMeanDistance = 2.3;      // m from the wall
constexpr int kLandmarksPerKeyframe = 40;  // in the first round
constexpr int kMinCommon = 40;             // common landmarks of a pair
constexpr int kMaxPairs = 10;              // with older keyframes

using Sightings = std::vector<SimulatedGraph::Sighting>;

Correspondences MatchesOf(const Camera& camera, const Sightings& ref,
                          const Sightings& cur) {
  Correspondences matches(camera);
  auto other = ref.begin();
  for (const SimulatedGraph::Sighting& sighting : cur) {
    while (other != ref.end() && other->landmark < sighting.landmark) ++other;
    if (other == ref.end()) break;
    if (other->landmark == sighting.landmark) {
      matches.Add(other->seen, sighting.seen);
    }
  }
  return matches;
}

}  // namespace

SimulatedGraph::SimulatedGraph(int keyframes, unsigned seed,
                               double focal_factor) {
  RandomWorld world(seed);
  const int round = keyframes / 2;
  const double wall = kStep * round / (2.0 * M_PI);
  const auto heading = [](double angle) {
    return Eigen::Quaterniond(
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  };
  landmarks = kLandmarksPerKeyframe * round;
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < landmarks; ++i) {
    const double angle = world.Uniform(0.0, 2.0 * M_PI);
    const double radius = wall + world.Uniform(-0.5, 0.5);
    points.push_back(heading(angle) *
                     Eigen::Vector3d(0.0, world.Uniform(-1.3, 1.3), radius));
  }
  const Camera real;
  for (int i = 0; i < keyframes; ++i) {
    const Eigen::Quaterniond turn = heading(2.0 * M_PI * i / round);
    const Rigid3d place(turn,
                        turn * Eigen::Vector3d(0.0, 0.0, wall - kMeanDistance));
    truth.push_back(place * world.Motion(0.1, 0.1));
    const Rigid3d cam_from_world = truth.back().Inverse();
    Sightings& seen = sightings.emplace_back();
    for (int k = 0; k < landmarks; ++k) {
      const Eigen::Vector3d point = cam_from_world * points[k];
      if (point.z() < 0.5 || point.z() > 5.0) continue;
      const Eigen::Vector2d pixel = real.Project(point);
      if (!real.Contains(pixel)) continue;
      Observation o;
      o.u = pixel.x();
      o.v = pixel.y();
      o.depth = point.z();
      o.sigma_depth =
          FindNamed(DepthNoiseModels(), "khoshelham")->sigma(o.depth);
      world.AddNoise(&o);
      seen.push_back({k, o});
    }
  }
  camera = real;
  camera.fx *= focal_factor;
  camera.fy *= focal_factor;
  for (int cur = 1; cur < keyframes; ++cur) {
    pairs.push_back(
        {cur - 1, cur, MatchesOf(camera, sightings[cur - 1], sightings[cur])});
  }
  for (int cur = 2; cur < keyframes; ++cur) {
    std::vector<Pair> found;  // oldest first
    for (int ref = 0; ref < cur - 1; ++ref) {
      Pair pair{ref, cur, MatchesOf(camera, sightings[ref], sightings[cur])};
      if (pair.matches.size() >= kMinCommon) found.push_back(std::move(pair));
    }
    // Keeps the oldest half and the most recent ones.
    while (found.size() > kMaxPairs - 1) {
      found.erase(found.begin() + kMaxPairs / 2);
    }
    std::move(found.begin(), found.end(), std::back_inserter(pairs));
  }
}

std::vector<RelativePose> SimulatedGraph::Edges() const {
  Estimator estimator({}, MakeRobustCosts("mahalanobis_point", "huber"));
  std::vector<RelativePose> edges;
  for (const Pair& pair : pairs) {
    const MotionEstimate estimate = estimator.Estimate(
        pair.matches, truth[pair.cur].Inverse() * truth[pair.ref]);
    edges.push_back(
        {pair.ref, pair.cur, estimate.cur_from_prev, estimate.covariance});
  }
  return edges;
}

std::vector<Rigid3d> OdometryOf(const SimulatedGraph& graph,
                                const std::vector<RelativePose>& edges) {
  std::vector<Rigid3d> poses = {graph.truth[0]};
  for (size_t i = 1; i < graph.truth.size(); ++i) {
    poses.push_back(poses.back() * edges[i - 1].cur_from_ref.Inverse());
  }
  return poses;
}

double RmsError(const std::vector<Rigid3d>& poses,
                const std::vector<Rigid3d>& truth) {
  std::vector<PosePair> pairs;
  for (size_t i = 0; i < poses.size(); ++i) {
    pairs.push_back({0.0, truth[i], poses[i]});
  }
  const Rigid3d aligned = AlignRigidly(pairs);
  double sum = 0.0;
  for (const PosePair& pair : pairs) {
    sum += ((aligned * pair.estimate.translation) - pair.truth.translation)
               .squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(pairs.size()));
}

}  // namespace rgbd_pose
