#include "frontend/features/descriptor_matching.h"

#include <cmath>
#include <numeric>
#include <opencv2/core/hal/hal.hpp>
#include <optional>

namespace rgbd_pose {
namespace {

double HammingDistance(const uchar* a, const uchar* b, int size) {
  return cv::hal::normHamming(a, b, size);
}

double EuclideanDistance(const uchar* a, const uchar* b, int size) {
  int sum = 0;
  for (int i = 0; i < size; ++i) {
    const int difference = a[i] - b[i];
    sum += difference * difference;
  }
  return std::sqrt(static_cast<double>(sum));
}

cv::Ptr<cv::Feature2D> MakeOrb(int max_keypoints) {
  const cv::Ptr<cv::ORB> orb = cv::ORB::create(max_keypoints);
  // Lower than OpenCV's 20, for dark or blurred frames; the strongest are kept.
  orb->setFastThreshold(10);
  return orb;
}

cv::Ptr<cv::Feature2D> MakeSift(int max_keypoints) {
  return cv::SIFT::create(max_keypoints, /*nOctaveLayers=*/3,
                          /*contrastThreshold=*/0.04, /*edgeThreshold=*/10.0,
                          /*sigma=*/1.6, /*descriptorType=*/CV_8U);
}

cv::Ptr<cv::Feature2D> MakeAkaze(int /*max_keypoints*/) {
  const cv::Ptr<cv::AKAZE> akaze = cv::AKAZE::create();
  // Half the default of OpenCV, for dark or blurred frames.
  akaze->setThreshold(0.0005F);
  // One fewer each than OpenCV's: 2/3 of the time, an equally good trajectory.
  akaze->setNOctaves(3);
  akaze->setNOctaveLayers(3);
  return akaze;
}

// The keypoints of an image in a grid, for searches within a radius.
class KeypointGrid {
 public:
  KeypointGrid(const std::vector<cv::KeyPoint>& keypoints, float cell_px)
      : keypoints_(keypoints), cell_px_(cell_px) {
    for (const cv::KeyPoint& keypoint : keypoints) {
      columns_ = std::max(columns_, Cell(keypoint.pt.x) + 1);
      rows_ = std::max(rows_, Cell(keypoint.pt.y) + 1);
    }
    cells_.resize(static_cast<size_t>(columns_) * rows_);
    for (size_t i = 0; i < keypoints.size(); ++i) {
      const cv::Point2f& p = keypoints[i].pt;
      cells_[Cell(p.y) * columns_ + Cell(p.x)].push_back(static_cast<int>(i));
    }
  }

  // Finds the keypoints within one cell width of a point.
  void Near(const cv::Point2f& p, std::vector<int>* near) const {
    near->clear();
    // Also finds nothing for NaN, or for what does not fit into an int.
    const float far = 1e6F * cell_px_;
    if (!(std::abs(p.x) < far && std::abs(p.y) < far)) return;
    const int column = Cell(p.x);
    const int row = Cell(p.y);
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1);
           c <= std::min(columns_ - 1, column + 1); ++c) {
        for (const int i : cells_[r * columns_ + c]) {
          const cv::Point2f offset = keypoints_[i].pt - p;
          if (offset.dot(offset) <= cell_px_ * cell_px_) near->push_back(i);
        }
      }
    }
  }

 private:
  int Cell(float x) const { return static_cast<int>(std::floor(x / cell_px_)); }

  const std::vector<cv::KeyPoint>& keypoints_;
  float cell_px_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::vector<int>> cells_;
};

struct Nearest {
  int place = -1;
  double distance = INFINITY;
};

// Returns the nearest candidate if it passes the ratio test.
Nearest FindDistinct(const std::vector<cv::KeyPoint>& keypoints,
                     const std::vector<int>& candidates,
                     const std::vector<double>& distances,
                     double max_distance) {
  // Maximum ratio of the best to the second-best distance (Lowe 2004).
  constexpr double kMaxRatio = 0.8;
  // Keypoints closer together than this are one place seen at several scales.
  // They do not compete in the ratio test.
  constexpr float kSameFeaturePx = 4.0F;
  Nearest best;
  for (size_t k = 0; k < candidates.size(); ++k) {
    if (distances[k] < best.distance) best = {candidates[k], distances[k]};
  }
  if (best.distance > max_distance) return {};
  const double limit = best.distance / kMaxRatio;
  for (size_t k = 0; k < candidates.size(); ++k) {
    if (distances[k] >= limit && distances[k] > best.distance) continue;
    const cv::Point2f offset =
        keypoints[candidates[k]].pt - keypoints[best.place].pt;
    if (offset.dot(offset) > kSameFeaturePx * kSameFeaturePx) return {};
  }
  return best;
}

}  // namespace

// Unrelated descriptors differ in 128 of 256 bits; places are whole pixels.
constexpr DescriptorMethod kOrb = {MakeOrb, HammingDistance, 64.0, 31.0, 0.7};
// Descriptors are vectors of norm 512.
constexpr DescriptorMethod kSift = {MakeSift, EuclideanDistance, 250.0, 1.8,
                                    0.5};
// Unrelated descriptors differ in 243 of 486 bits.
constexpr DescriptorMethod kAkaze = {MakeAkaze, HammingDistance, 121.0, 4.8,
                                     0.5};

DescribedKeypoints::DescribedKeypoints(const Frame& frame,
                                       const DescriptorMethod* method,
                                       int max_keypoints) {
  // OpenCV does not state that a detector may be used by several threads.
  method->make(max_keypoints)
      ->detectAndCompute(frame.gray, cv::noArray(), keypoints, descriptors);
}

DescribedKeypoints DescribedKeypoints::Select(
    const std::vector<int>& places) const {
  DescribedKeypoints selected;
  for (const int place : places) {
    selected.keypoints.push_back(keypoints[place]);
    selected.descriptors.push_back(descriptors.row(place));
  }
  return selected;
}

std::vector<KeypointMatch> MatchKeypoints(const DescriptorMethod& method,
                                          const DescribedKeypoints& reference,
                                          const DescribedKeypoints& current,
                                          const SearchGuide* guide) {
  const int size = current.descriptors.cols;
  std::vector<int> candidates(current.keypoints.size());
  std::iota(candidates.begin(), candidates.end(), 0);
  std::optional<KeypointGrid> grid;
  if (guide != nullptr) grid.emplace(current.keypoints, guide->radius_px);
  std::vector<double> distances;
  std::vector<Nearest> nearest_reference(current.keypoints.size());
  std::vector<KeypointMatch> found;
  for (int i = 0; i < static_cast<int>(reference.keypoints.size()); ++i) {
    if (grid) grid->Near(guide->expected[i], &candidates);
    distances.resize(candidates.size());
    for (size_t k = 0; k < candidates.size(); ++k) {
      distances[k] =
          method.distance(reference.descriptors.ptr(i),
                          current.descriptors.ptr(candidates[k]), size);
      Nearest& nearest = nearest_reference[candidates[k]];
      if (distances[k] < nearest.distance) nearest = {i, distances[k]};
    }
    const Nearest best = FindDistinct(current.keypoints, candidates, distances,
                                      method.max_distance);
    if (best.place >= 0) found.push_back({i, best.place});
  }
  std::vector<KeypointMatch> mutual;
  for (const KeypointMatch& match : found) {
    const int nearest = nearest_reference[match.current].place;
    if (nearest == match.reference) mutual.push_back(match);
  }
  return mutual;
}

}  // namespace rgbd_pose
