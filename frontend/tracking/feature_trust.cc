#include "frontend/tracking/feature_trust.h"

#include <algorithm>
#include <utility>

#include "frontend/tracking/seen_at.h"

namespace rgbd_pose {
namespace {

// Frames in which a doubted feature has to agree: what moves at a few
// centimetres a second has moved by several sigmas after as many.
constexpr int kAgreements = 3;

// A doubted match agrees if it is so near (px) to where the motion puts it: 3
// sigmas of 0.7 px.
constexpr double kMaxErrorPx = 2.0;

// Features fail together within cells of this size (px): some six features of a
// well textured view.
constexpr double kTrustCellPx = 64.0;

// One failed feature in a cell is chance.
constexpr int kMinFailed = 2;

// Whether a match is where the motion puts it.
bool Agrees(const FeatureMatches& found, size_t i,
            const Rigid3d& cur_from_ref) {
  const Observation& cur = found.matches[i].cur;
  const auto expected =
      SeenAt(found.matches.camera(), cur_from_ref, found.matches[i].prev);
  return expected.has_value() &&
         (*expected - Eigen::Vector2d(cur.u, cur.v)).norm() <= kMaxErrorPx;
}

// Counts of features by cells of the image; those outside count nowhere.
class CellCounts {
 public:
  explicit CellCounts(const Camera& camera)
      : columns_(static_cast<int>(camera.width / kTrustCellPx) + 1),
        rows_(static_cast<int>(camera.height / kTrustCellPx) + 1),
        counts_(columns_ * rows_, 0),
        spare_(0) {}

  int& At(const Eigen::Vector2d& pixel) {
    if (!(pixel.x() >= 0.0 && pixel.y() >= 0.0)) return spare_;
    const int column = static_cast<int>(pixel.x() / kTrustCellPx);
    const int row = static_cast<int>(pixel.y() / kTrustCellPx);
    if (column >= columns_ || row >= rows_) return spare_;
    return counts_[row * columns_ + column];
  }

 private:
  int columns_, rows_;
  std::vector<int> counts_;
  int spare_;
};

}  // namespace

FeatureTrust::FeatureTrust(const FeatureSet& last, const FeatureMatches& found,
                           const FeatureMatches& doubted,
                           const MotionEstimate& estimate, bool missing_failed,
                           const FeatureSet& fresh, size_t min_trusted)
    : doubts_(fresh.observations.size(), 0) {
  const Camera& camera = found.matches.camera();
  std::vector<bool> agrees(last.observations.size(), false);
  std::vector<bool> counts(last.observations.size(), missing_failed);
  for (size_t i = 0; i < found.features.size(); ++i) {
    counts.at(found.features[i]) = true;  // throws if of another reference
    if (estimate.is_inlier[i]) agrees[found.features[i]] = true;
  }
  // Otherwise references in quick succession would never trust them.
  for (size_t i = 0; i < doubted.features.size(); ++i) {
    counts.at(doubted.features[i]) = true;
    agrees.at(doubted.features[i]) = Agrees(doubted, i, estimate.cur_from_prev);
  }
  CellCounts agreed(camera), failed(camera);
  for (size_t i = 0; i < agrees.size(); ++i) {
    if (!counts[i]) continue;
    const auto pixel =
        SeenAt(camera, estimate.cur_from_prev, last.observations[i]);
    if (pixel.has_value()) ++(agrees[i] ? agreed : failed).At(*pixel);
  }
  for (size_t i = 0; i < doubts_.size(); ++i) {
    const Observation& o = fresh.observations[i];
    const int failures = failed.At({o.u, o.v});
    if (failures >= kMinFailed && failures > agreed.At({o.u, o.v})) {
      doubts_[i] = kAgreements;
    }
  }
  if (num_trusted() < min_trusted) doubts_.assign(doubts_.size(), 0);
}

size_t FeatureTrust::num_trusted() const {
  return std::count(doubts_.begin(), doubts_.end(), 0);
}

void FeatureTrust::Split(FeatureMatches* found, FeatureMatches* doubted) const {
  doubted->Clear();
  if (num_trusted() == doubts_.size()) return;
  FeatureMatches trusted{Correspondences(found->matches.camera()), {}};
  for (size_t i = 0; i < found->features.size(); ++i) {
    const int feature = found->features[i];
    FeatureMatches& part = doubts_[feature] == 0 ? trusted : *doubted;
    part.matches.Add(found->matches[i].prev, found->matches[i].cur);
    part.features.push_back(feature);
  }
  *found = std::move(trusted);
}

void FeatureTrust::Learn(const FeatureMatches& doubted,
                         const Rigid3d& cur_from_ref) {
  for (size_t i = 0; i < doubted.features.size(); ++i) {
    const bool agrees = Agrees(doubted, i, cur_from_ref);
    int& doubt = doubts_[doubted.features[i]];
    doubt = agrees ? doubt - 1 : kAgreements;
  }
}

}  // namespace rgbd_pose
