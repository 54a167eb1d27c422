#include <algorithm>
#include <string>
#include <utility>

#include "frontend/slam/mapper.h"

// This file finds the keyframes that see the place of the newest one, and
// measures the motions between them.

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

// Number of references kept, about 3 MB each.
constexpr size_t kMaxReferences = 24;

// Limits of a good pair: the share of the view that is visible, and the spread
// of the residuals in sigmas.
constexpr double kMinSeenShare = 0.1;
constexpr double kMaxPairSigma = 3.0;

// A pair farther from its initial guess, by poses or descriptors, is wrong.
constexpr double kMaxPairRotation = 0.2;     // rad
constexpr double kMaxPairTranslation = 0.3;  // m

// Whether two motions differ by at most `rotation` (rad) and `translation` (m).
bool IsWithin(const Rigid3d& a, const Rigid3d& b, double rotation,
              double translation) {
  const Rigid3d moved = a.Inverse() * b;
  return moved.Angle() <= rotation && moved.translation.norm() <= translation;
}

}  // namespace

// The share of each view that the other one sees, the smaller of both. 0 if
// their scales differ too much.
double Mapper::SharedView(int ref, int cur, const Rigid3d& cur_from_ref) const {
  const Overlap there = keyframes_[ref].samples.SeenFrom(cur_from_ref);
  if (there.share < options_.min_pair_share) return 0.0;
  const Overlap back = keyframes_[cur].samples.SeenFrom(cur_from_ref.Inverse());
  if (std::max(there.zoom, back.zoom) > kMaxPairZoom) return 0.0;
  return std::min(there.share, back.share);
}

std::vector<int> Mapper::SeeingTheSame(int newest) const {
  std::vector<std::pair<double, int>> seen;
  for (int at = 0; at < newest; ++at) {
    if (graph_.IsRemoved(at) || graph_.segment(at) != graph_.segment(newest) ||
        graph_.links().AreJoined(at, newest)) {
      continue;
    }
    const double share = SharedView(at, newest, graph_.CurFromRef(at, newest));
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

// The motion between two keyframes, if it is reliable and near the initial
// guess, with a covariance that includes timing errors. `frame` belongs to
// `cur`.
std::optional<RelativePose> Mapper::MakePair(int ref, int cur,
                                             const PreparedFrame& frame,
                                             const Rigid3d& cur_from_ref_guess,
                                             double min_inlier_share) {
  const Reference* reference = ReferenceOf(ref);
  if (reference == nullptr) return std::nullopt;
  tracker_->Track(*reference, frame, cur_from_ref_guess, &tracked_);
  const MotionEstimate& estimate = tracked_.estimate;
  if (tracked_.status != TrackingStatus::kOk || !estimate.ok() ||
      estimate.num_inliers < min_inlier_share * estimate.num_used ||
      estimate.sigma > kMaxPairSigma ||
      tracked_.overlap.share < kMinSeenShare ||
      !IsWithin(estimate.cur_from_prev, cur_from_ref_guess, kMaxPairRotation,
                kMaxPairTranslation)) {
    return std::nullopt;
  }
  const MotionMatrix timing =
      keyframes_[ref].timing_covariance + keyframes_[cur].timing_covariance;
  return RelativePose{ref, cur, estimate.cur_from_prev,
                      estimate.covariance + timing};
}

const Reference* Mapper::ReferenceOf(int at) {
  const auto made =
      std::find_if(references_.begin(), references_.end(),
                   [=](const auto& entry) { return entry.first == at; });
  if (made != references_.end()) {
    references_.splice(references_.begin(), references_, made);
    return references_.front().second.get();
  }
  std::string why_not;
  auto reference = tracker_->MakeReference(keyframes_[at].Unpacked(), nullptr,
                                           nullptr, &why_not);
  if (reference == nullptr) return nullptr;
  if (references_.size() == kMaxReferences) references_.pop_back();
  references_.emplace_front(at, std::move(reference));
  return references_.front().second.get();
}

// Pairs the newest keyframe with those of its segment that see the same.
void Mapper::PairByPose(int newest, const PreparedFrame& frame) {
  for (const int at : SeeingTheSame(newest)) {
    const bool is_loop = !graph_.links().Within(newest, kLoopHops)[at];
    const auto edge =
        MakePair(at, newest, frame, graph_.CurFromRef(at, newest), 0.0);
    if (edge.has_value()) graph_.AddPair(*edge, /*is_tracked=*/false, is_loop);
  }
}

// Pairs the newest keyframe with similar ones of any segment. Segments that
// meet are joined. A similar keyframe is accepted if the path by other pairs is
// consistent with it or, without a path, if more than one pair supports it.
// Returns the number of segments joined.
int Mapper::CloseLoopsByAppearance(int newest, const PreparedFrame& frame) {
  if (options_.max_loop_candidates == 0) return 0;
  int joined = 0;
  const PlaceFeatures& cur = *keyframes_[newest].features;
  const std::vector<bool> is_near = graph_.links().Within(newest, kLoopHops);
  const auto filter = [&](int at) { return !is_near[at]; };
  const std::vector<PlaceCandidate> alike = index_.Query(
      cur.described.descriptors, options_.max_loop_candidates, filter);
  for (const PlaceCandidate& candidate : alike) {
    if (candidate.score < kMinScoreShare * alike.front().score) break;
    const int at = candidate.keyframe;
    const auto rough = VerifyGeometrically(*keyframes_[at].features, cur,
                                           tracker_->images().camera);
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
      ++joined;
    } else if (!graph_.PassesMahalanobisGate(*edge)) {
      continue;
    }
    graph_.AddPair(*edge, /*is_tracked=*/false, /*is_loop=*/true);
  }
  return joined;
}

// Whether a pair with a neighbour of edge.ref gives the same motion.
bool Mapper::AgreesWithOthers(const RelativePose& edge,
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
bool Mapper::AreConnected(const RelativePose& edge) {
  const Rigid3d ref_from_cur = graph_.pose(edge.ref) *
                               edge.cur_from_ref.Inverse() *
                               graph_.pose(edge.cur).Inverse();
  std::vector<Rigid3d>& meetings =
      meetings_[{graph_.segment(edge.ref), graph_.segment(edge.cur)}];
  for (const Rigid3d& earlier : meetings) {
    // The motions are compared where the camera is, because far from the origin
    // of a segment a small rotation is a large translation.
    if (IsWithin(earlier * graph_.pose(edge.cur),
                 ref_from_cur * graph_.pose(edge.cur), kMeetingRotation,
                 kMeetingTranslation)) {
      return true;
    }
  }
  meetings.push_back(ref_from_cur);
  return false;
}

}  // namespace rgbd_pose
