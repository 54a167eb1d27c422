// Keyframes of a path that returns: which of them show the same place?
#include <cstdio>
#include <memory>
#include <vector>

#include "costs/cost_factory.h"
#include "frontend/places/place_checker.h"
#include "frontend/places/place_index.h"
#include "frontend/simulation/synthetic_dataset.h"

int main() {
  rgbd_pose::SyntheticOptions tour;
  tour.scene = tour.path = "table";
  tour.frames = 31;
  tour.rate_hz = 0.5;  // a keyframe every 2 s
  const rgbd_pose::SyntheticDataset sequence(tour);
  rgbd_pose::FrontendOptions options;
  options.camera = sequence.camera().camera;
  rgbd_pose::PlaceChecker checker(
      rgbd_pose::MakeFrontend("patch", options),
      rgbd_pose::Estimator({}, rgbd_pose::MakeRobustCosts()));
  rgbd_pose::PlaceIndex index;
  std::vector<rgbd_pose::PlaceFeatures> places;
  std::vector<std::unique_ptr<rgbd_pose::FeatureSet>> features;
  for (int i = 0; i < sequence.size(); ++i) {
    const auto frame = checker.frontend().Prepare(sequence.Read(i));
    places.push_back(rgbd_pose::DescribeKeyframe(*frame, options.camera,
                                                 options.DepthLookup()));
    const cv::Mat& descriptors = places[i].described.descriptors;
    const auto is_old = [i](int keyframe) { return keyframe < i - 5; };
    for (const auto& [old, score] : index.Query(descriptors, 3, is_old)) {
      const rgbd_pose::PlaceCheck check =
          checker.Check(places[old], *features[old], places[i], *frame);
      if (!check.ok) continue;  // check.reason says why
      std::printf("%d shows what %d shows, from %.2f m away\n", i, old,
                  check.cur_from_ref.translation.norm());
    }
    index.Add(i, descriptors);
    features.push_back(checker.frontend().Detect(*frame));
  }
  return 0;
}
