#include "frontend/mapping/keyframe_pairing.h"

#include <algorithm>
#include <utility>

#include "frontend/mapping/pair_tracker.h"
#include "frontend/places/relocaliser.h"

namespace rgbd_pose {
namespace {

// Minimum score of a candidate, relative to the best one.
constexpr double kMinScoreShare = 0.5;

// Maximum ratio of scales between the views of a pair. With a larger ratio one
// of the cameras is far away, where depth is not reliable.
constexpr double kMaxPairZoom = 1.5;

// A pair closes a loop if it links keyframes more than this many links apart.
constexpr int kLoopHops = 4;

// Minimum share of inliers of a pair found only by appearance.
constexpr double kMinLookalikeInliers = 0.5;

// Two pairs between the same segments agree if they differ by less than this.
constexpr double kMeetingRotation = 0.05;    // rad
constexpr double kMeetingTranslation = 0.1;  // m

}  // namespace

double KeyframePairing::SharedView(int ref, int cur,
                                   const Rigid3d& cur_from_ref) const {
  const Overlap there = keyframes_[ref].samples.SeenFrom(cur_from_ref);
  if (there.share < options_.min_pair_share) return 0.0;
  const Overlap back = keyframes_[cur].samples.SeenFrom(cur_from_ref.Inverse());
  if (std::max(there.zoom, back.zoom) > kMaxPairZoom) return 0.0;
  return std::min(there.share, back.share);
}

std::vector<int> KeyframePairing::SeeingTheSame(int newest) const {
  std::vector<std::pair<double, int>> seen;
  for (int at = 0; at < newest; ++at) {
    if (graph_.IsRemoved(at) || graph_.segment(at) != graph_.segment(newest) ||
        graph_.links().AreJoined(at, newest)) {
      continue;
    }
    const Rigid3d cur_from_ref =
        graph_.pose(newest).Inverse() * graph_.pose(at);
    const double share = SharedView(at, newest, cur_from_ref);
    if (share >= options_.min_pair_share) seen.emplace_back(-share, at);
  }
  std::sort(seen.begin(), seen.end());
  const size_t most = options_.max_pairs;
  if (seen.size() > most) {
    const auto rest = seen.begin() + (most + 1) / 2;
    std::sort(rest, seen.end(),
              [](const auto& a, const auto& b) { return a.second < b.second; });
    seen.resize(most);
  }
  std::vector<int> result;
  for (const auto& [share, at] : seen) result.push_back(at);
  return result;
}

// PairTracker's pair with the covariance increased by timing errors.
std::optional<RelativePose> KeyframePairing::MakePair(
    int ref, int cur, const PreparedFrame& frame,
    const Rigid3d& cur_from_ref_guess, double min_inlier_share) {
  auto pair = tracker_.MakePair(ref, cur, keyframes_[ref], frame,
                                cur_from_ref_guess, min_inlier_share);
  if (pair.has_value()) {
    pair->covariance +=
        keyframes_[ref].timing_covariance + keyframes_[cur].timing_covariance;
  }
  return pair;
}

void KeyframePairing::PairByPose(int newest, const PreparedFrame& frame,
                                 MapUpdate* update) {
  for (const int at : SeeingTheSame(newest)) {
    const bool is_loop =
        graph_.links().Hops(newest, at, kLoopHops + 1) > kLoopHops;
    const auto edge =
        MakePair(at, newest, frame,
                 graph_.pose(newest).Inverse() * graph_.pose(at), 0.0);
    if (!edge.has_value()) continue;
    graph_.AddPair(*edge, /*is_tracked=*/false, is_loop);
    ++update->pairs;
    update->loops += is_loop;
  }
}

// A similar keyframe is accepted if the path by other pairs is consistent with
// it or, without a path, if more than one pair supports it.
void KeyframePairing::CloseLoopsByAppearance(int newest,
                                             const PreparedFrame& frame,
                                             MapUpdate* update) {
  if (options_.max_loop_candidates == 0) return;
  const PlaceFeatures& cur = *keyframes_[newest].features;
  const std::vector<bool> is_near = graph_.links().Within(newest, kLoopHops);
  const auto filter = [&](int at) { return !is_near[at]; };
  const std::vector<PlaceCandidate> alike = index_.Query(
      cur.described.descriptors, options_.max_loop_candidates, filter);
  for (const PlaceCandidate& candidate : alike) {
    if (candidate.score < kMinScoreShare * alike.front().score) break;
    const int at = candidate.keyframe;
    const auto rough = VerifyGeometrically(
        MatchPlaces(*keyframes_[at].features, cur, tracker_.images().camera));
    if (!rough.has_value()) continue;
    const auto edge =
        MakePair(at, newest, frame, rough->cur_from_prev, kMinLookalikeInliers);
    if (!edge.has_value() ||
        SharedView(at, newest, edge->cur_from_ref) == 0.0) {
      continue;
    }
    if (graph_.segment(at) != graph_.segment(newest)) {
      if (!AgreesWithOthers(*edge, frame) && !AreConnected(*edge)) continue;
      if (!graph_.Join(*edge)) continue;
      ++update->joined;
    } else if (!graph_.PassesMahalanobisGate(*edge)) {
      continue;
    }
    graph_.AddPair(*edge, /*is_tracked=*/false, /*is_loop=*/true);
    ++update->pairs;
    ++update->loops;
  }
}

// Whether a pair with a neighbour of edge.ref gives the same motion.
bool KeyframePairing::AgreesWithOthers(const RelativePose& edge,
                                       const PreparedFrame& frame) {
  const std::vector<int> neighbors = graph_.links().Neighbors(edge.ref);
  for (const int at : neighbors) {
    const Rigid3d guess =
        edge.cur_from_ref * graph_.pose(edge.ref).Inverse() * graph_.pose(at);
    if (SharedView(at, edge.cur, guess) < options_.min_pair_share) continue;
    const auto other =
        MakePair(at, edge.cur, frame, guess, kMinLookalikeInliers);
    if (other.has_value() && IsWithin(other->cur_from_ref, guess,
                                      kMeetingRotation, kMeetingTranslation)) {
      return true;
    }
  }
  return false;
}

// Whether an earlier pair between the two segments gave the same motion.
// Otherwise this one is remembered.
bool KeyframePairing::AreConnected(const RelativePose& edge) {
  const Meeting meeting = {graph_.segment(edge.ref), graph_.segment(edge.cur),
                           graph_.pose(edge.ref) * edge.cur_from_ref.Inverse() *
                               graph_.pose(edge.cur).Inverse()};
  for (const Meeting& earlier : meetings_) {
    if (earlier.ref_segment == meeting.ref_segment &&
        earlier.cur_segment == meeting.cur_segment &&
        IsWithin(earlier.ref_from_cur, meeting.ref_from_cur, kMeetingRotation,
                 kMeetingTranslation)) {
      return true;
    }
  }
  meetings_.push_back(meeting);
  return false;
}

}  // namespace rgbd_pose
