#include "frontend/tracking/moving_regions.h"

#include <algorithm>
#include <vector>

#include "frontend/tracking/cell_counts.h"
#include "frontend/tracking/seen_at.h"

namespace rgbd_pose {

bool AgreesWithMotion(const FeatureMatches& found, size_t i,
                      const Rigid3d& cur_from_ref) {
  constexpr double kMaxErrorPx = 2.0;
  const Observation& cur = found.matches[i].cur;
  const auto expected =
      SeenAt(found.matches.camera(), cur_from_ref, found.matches[i].prev);
  return expected.has_value() &&
         (*expected - Eigen::Vector2d(cur.u, cur.v)).norm() <= kMaxErrorPx;
}

int CellsOfInliers(const FeatureMatches& found,
                   const MotionEstimate& estimate) {
  CellCounts counts(found.matches.camera());
  for (size_t i = 0; i < found.matches.size(); ++i) {
    const Observation& cur = found.matches[i].cur;
    if (estimate.is_inlier[i]) ++counts.At({cur.u, cur.v});
  }
  return counts.num_covered();
}

double MarkMoving(const FeatureSet& reference, const FeatureMatches& found,
                  const FeatureMatches& on_probation,
                  const MotionEstimate& estimate, bool missing_contradict,
                  CellMask* moving) {
  // A feature votes for the cells around it. A feature that is not found may be
  // hidden or only blurred.
  constexpr int kReachCells = 2;
  constexpr int kFound = 3, kMissing = 1, kContradicted = 8;
  const Camera& camera = found.matches.camera();
  const int columns = (camera.width - 1) / CellMask::kCellPx + 1;
  const int rows = (camera.height - 1) / CellMask::kCellPx + 1;
  std::vector<int> votes(columns * rows, 0);
  std::vector<bool> has_features(votes.size()), agrees(votes.size());
  // Takes an ideal pixel, without lens distortion.
  const auto vote = [&](const Eigen::Vector2d& ideal, int count) {
    const Eigen::Vector2d pixel =
        camera.HasDistortion()
            ? camera.Project(camera.Ray(ideal.x(), ideal.y()))
            : ideal;
    const int column = static_cast<int>(pixel.x() / CellMask::kCellPx);
    const int row = static_cast<int>(pixel.y() / CellMask::kCellPx);
    const int last_row = std::min(row + kReachCells, rows - 1);
    const int last_column = std::min(column + kReachCells, columns - 1);
    for (int r = std::max(row - kReachCells, 0); r <= last_row; ++r) {
      for (int c = std::max(column - kReachCells, 0); c <= last_column; ++c) {
        votes[r * columns + c] += count;
        if (std::abs(r - row) > 1 || std::abs(c - column) > 1) continue;
        has_features[r * columns + c] = true;
        if (count > 0) agrees[r * columns + c] = true;
      }
    }
  };
  std::vector<bool> is_found(reference.observations.size(), false);
  for (size_t i = 0; i < found.features.size(); ++i) {
    const Observation& cur = found.matches[i].cur;
    vote({cur.u, cur.v}, estimate.is_inlier[i] ? kFound : -kFound);
    is_found[found.features[i]] = true;
  }
  for (size_t i = 0; i < on_probation.features.size(); ++i) {
    const Observation& cur = on_probation.matches[i].cur;
    const bool has_agreed =
        AgreesWithMotion(on_probation, i, estimate.cur_from_prev);
    vote({cur.u, cur.v}, has_agreed ? kFound : -kFound);
    is_found[on_probation.features[i]] = true;
  }
  for (size_t i = 0; missing_contradict && i < is_found.size(); ++i) {
    if (is_found[i]) continue;
    const auto pixel =
        SeenAt(camera, estimate.cur_from_prev, reference.observations[i]);
    if (pixel.has_value() && camera.Contains(*pixel)) {
      vote(*pixel, -kMissing);
    }
  }
  moving->columns = columns;
  moving->cells.resize(votes.size());
  for (size_t i = 0; i < votes.size(); ++i) {
    moving->cells[i] = votes[i] <= -kContradicted;
  }
  const auto count = [](const std::vector<bool>& cells) {
    return std::count(cells.begin(), cells.end(), true);
  };
  return count(agrees) / std::max(1.0, 1.0 * count(has_features));
}

}  // namespace rgbd_pose
