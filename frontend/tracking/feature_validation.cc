#include "frontend/tracking/feature_validation.h"

#include <algorithm>
#include <utility>

namespace rgbd_pose {
namespace {

// Number of frames in which a feature on probation has to agree. Until then, an
// object with a few centimetres per second has moved by several sigmas.
constexpr int kAgreements = 3;

// A single failed feature in a cell may be chance.
constexpr int kMinFailed = 2;

// Whether match `i` is within 2 px of its prediction (3 sigmas of 0.7 px).
bool AgreesWithMotion(const FeatureMatches& found, size_t i,
                      const Rigid3d& cur_from_ref) {
  constexpr double kMaxErrorPx = 2.0;
  const Observation& cur = found.matches[i].cur;
  const auto expected =
      SeenAt(found.matches.camera(), cur_from_ref, found.matches[i].prev);
  return expected.has_value() &&
         (*expected - Eigen::Vector2d(cur.u, cur.v)).norm() <= kMaxErrorPx;
}

// Counts features in square cells of an image; pixels outside are ignored.
class CellCounts {
 public:
  explicit CellCounts(const Camera& camera)
      : counts_(Eigen::ArrayXXi::Zero(camera.height / kCellPx + 1,
                                      camera.width / kCellPx + 1)) {}

  // Number of cells with at least one feature.
  int num_covered() const { return static_cast<int>((counts_ > 0).count()); }

  int& At(const Eigen::Vector2d& pixel) {
    if (!(pixel.x() >= 0.0 && pixel.y() >= 0.0)) return outside_ = 0;
    const int row = static_cast<int>(pixel.y() / kCellPx);
    const int column = static_cast<int>(pixel.x() / kCellPx);
    if (row >= counts_.rows() || column >= counts_.cols()) return outside_ = 0;
    return counts_(row, column);
  }

 private:
  // Side of a cell. A cell of a well textured view has about six features.
  static constexpr int kCellPx = 64;

  Eigen::ArrayXXi counts_;
  int outside_ = 0;
};

// Votes of features on the cells of a CellMask: for the motion, or against it.
class MotionVotes {
 public:
  explicit MotionVotes(const Camera& camera)
      : camera_(camera),
        columns_((camera.width - 1) / CellMask::kCellPx + 1),
        rows_((camera.height - 1) / CellMask::kCellPx + 1),
        votes_(columns_ * rows_, 0),
        has_features_(votes_.size()),
        agrees_(votes_.size()) {}

  // A feature votes for the cells around it. Takes an ideal pixel, without lens
  // distortion.
  void Add(const Eigen::Vector2d& ideal, int count) {
    constexpr int kReachCells = 2;
    const Eigen::Vector2d pixel =
        camera_.HasDistortion()
            ? camera_.Project(camera_.Ray(ideal.x(), ideal.y()))
            : ideal;
    const int column = static_cast<int>(pixel.x() / CellMask::kCellPx);
    const int row = static_cast<int>(pixel.y() / CellMask::kCellPx);
    const int last_row = std::min(row + kReachCells, rows_ - 1);
    const int last_column = std::min(column + kReachCells, columns_ - 1);
    for (int r = std::max(row - kReachCells, 0); r <= last_row; ++r) {
      for (int c = std::max(column - kReachCells, 0); c <= last_column; ++c) {
        votes_[r * columns_ + c] += count;
        if (std::abs(r - row) > 1 || std::abs(c - column) > 1) continue;
        has_features_[r * columns_ + c] = true;
        if (count > 0) agrees_[r * columns_ + c] = true;
      }
    }
  }

  // Marks the cells with at least so many more votes against the motion.
  void MarkContradicted(int votes, CellMask* mask) const {
    mask->columns = columns_;
    mask->cells.clear();
    for (const int sum : votes_) mask->cells.push_back(sum <= -votes);
  }

  // The share of the regions with features in which some agree.
  double AgreeingShare() const {
    const auto count = [](const std::vector<bool>& cells) {
      return std::count(cells.begin(), cells.end(), true);
    };
    return count(agrees_) / std::max(1.0, 1.0 * count(has_features_));
  }

 private:
  const Camera& camera_;
  const int columns_, rows_;
  std::vector<int> votes_;
  std::vector<bool> has_features_, agrees_;  // next to the cell
};

}  // namespace

FeatureValidation::FeatureValidation(const FeatureSet& last,
                                     const TrackingResult& tracked,
                                     bool missing_failed,
                                     const FeatureSet& fresh,
                                     size_t min_trusted)
    : agreements_needed_(fresh.observations.size(), 0) {
  const FeatureMatches& found = tracked.matches;
  const FeatureMatches& on_probation = tracked.on_probation;
  const Rigid3d& cur_from_last = tracked.estimate.cur_from_prev;
  const Camera& camera = found.matches.camera();
  std::vector<bool> agrees(last.observations.size(), false);
  std::vector<bool> counts(last.observations.size(), missing_failed);
  for (size_t i = 0; i < found.features.size(); ++i) {
    // Throws if of another reference. Matches that no cost could use, such as
    // those without depth, tell nothing.
    counts.at(found.features[i]) = tracked.estimate.residual_degrees[i] > 0;
    if (tracked.estimate.is_inlier[i]) agrees[found.features[i]] = true;
  }
  // Count these too: with frequent new references they would never be trusted.
  for (size_t i = 0; i < on_probation.features.size(); ++i) {
    counts.at(on_probation.features[i]) = true;
    agrees[on_probation.features[i]] =
        AgreesWithMotion(on_probation, i, cur_from_last);
  }
  CellCounts agreed(camera), failed(camera);
  for (size_t i = 0; i < agrees.size(); ++i) {
    if (!counts[i]) continue;
    const auto pixel = SeenAt(camera, cur_from_last, last.observations[i]);
    if (pixel.has_value()) ++(agrees[i] ? agreed : failed).At(*pixel);
  }
  for (size_t i = 0; i < agreements_needed_.size(); ++i) {
    const Observation& o = fresh.observations[i];
    const int failures = failed.At({o.u, o.v});
    if (failures >= kMinFailed && failures > agreed.At({o.u, o.v})) {
      agreements_needed_[i] = kAgreements;
    }
  }
  if (num_trusted() < min_trusted)
    agreements_needed_.assign(agreements_needed_.size(), 0);
}

size_t FeatureValidation::num_trusted() const {
  return std::count(agreements_needed_.begin(), agreements_needed_.end(), 0);
}

void FeatureValidation::Split(FeatureMatches* found,
                              FeatureMatches* on_probation) const {
  on_probation->Clear();
  if (num_trusted() == agreements_needed_.size()) return;
  FeatureMatches trusted{Correspondences(found->matches.camera()), {}};
  for (size_t i = 0; i < found->features.size(); ++i) {
    const bool is_trusted = agreements_needed_[found->features[i]] == 0;
    (is_trusted ? trusted : *on_probation).AddFrom(*found, i);
  }
  *found = std::move(trusted);
}

void FeatureValidation::Learn(const FeatureMatches& on_probation,
                              const Rigid3d& cur_from_ref) {
  for (size_t i = 0; i < on_probation.features.size(); ++i) {
    const bool agrees = AgreesWithMotion(on_probation, i, cur_from_ref);
    int& needed = agreements_needed_[on_probation.features[i]];
    needed = agrees ? std::max(0, needed - 1) : kAgreements;
  }
}

int CellsOfInliers(const TrackingResult& tracked) {
  const Correspondences& matches = tracked.matches.matches;
  CellCounts counts(matches.camera());
  for (size_t i = 0; i < matches.size(); ++i) {
    const Observation& cur = matches[i].cur;
    if (tracked.estimate.is_inlier[i]) ++counts.At({cur.u, cur.v});
  }
  return counts.num_covered();
}

double MarkMoving(const FeatureSet& reference, bool missing_contradict,
                  TrackingResult* tracked) {
  // A feature that is not found may be hidden or only blurred.
  constexpr int kFound = 3, kMissing = 1, kContradicted = 8;
  const FeatureMatches& found = tracked->matches;
  const FeatureMatches& on_probation = tracked->on_probation;
  const Rigid3d& cur_from_ref = tracked->estimate.cur_from_prev;
  const Camera& camera = found.matches.camera();
  MotionVotes votes(camera);
  std::vector<bool> is_found(reference.observations.size(), false);
  for (size_t i = 0; i < found.features.size(); ++i) {
    const Observation& cur = found.matches[i].cur;
    is_found[found.features[i]] = true;
    if (tracked->estimate.residual_degrees[i] == 0) continue;  // tells nothing
    votes.Add({cur.u, cur.v},
              tracked->estimate.is_inlier[i] ? kFound : -kFound);
  }
  for (size_t i = 0; i < on_probation.features.size(); ++i) {
    const Observation& cur = on_probation.matches[i].cur;
    const bool has_agreed = AgreesWithMotion(on_probation, i, cur_from_ref);
    votes.Add({cur.u, cur.v}, has_agreed ? kFound : -kFound);
    is_found[on_probation.features[i]] = true;
  }
  for (size_t i = 0; missing_contradict && i < is_found.size(); ++i) {
    if (is_found[i]) continue;
    const auto pixel = SeenAt(camera, cur_from_ref, reference.observations[i]);
    if (pixel.has_value() && camera.Contains(*pixel)) {
      votes.Add(*pixel, -kMissing);
    }
  }
  votes.MarkContradicted(kContradicted, &tracked->moving);
  return votes.AgreeingShare();
}

}  // namespace rgbd_pose
