// Keyframes of a path that returns: which of them show the same place?
#include <cstdio>
#include <vector>

#include "rgbd_pose/frontend/frame/depth_lookup.h"
#include "rgbd_pose/frontend/places/place_database.h"
#include "rgbd_pose/frontend/places/place_features.h"
#include "rgbd_pose/frontend/simulation/synthetic_dataset.h"

int main() {
  rgbd_pose::SyntheticOptions tour;
  tour.scene = tour.path = "table";
  tour.frames = 31;
  tour.rate_hz = 0.5;  // a keyframe every 2 s
  const rgbd_pose::SyntheticDataset sequence(tour);
  const rgbd_pose::Camera camera = sequence.camera().camera;
  rgbd_pose::PlaceDatabase index;
  std::vector<rgbd_pose::PlaceFeatures> places;
  for (int i = 0; i < sequence.size(); ++i) {
    const rgbd_pose::PreparedFrame frame(sequence.Read(i));
    places.push_back(rgbd_pose::DescribeKeyframe(frame, {camera}));
    const cv::Mat& descriptors = places[i].described.descriptors;
    const auto is_old = [i](int keyframe) { return keyframe < i - 5; };
    for (const auto& [old, score] : index.Query(descriptors, 3, is_old)) {
      const auto rough =
          rgbd_pose::VerifyGeometrically(places[old], places[i], camera);
      if (!rough.has_value()) continue;  // another place
      std::printf("%d shows what %d shows, from %.2f m away\n", i, old,
                  rough->cur_from_prev.translation.norm());
    }
    index.Add(i, descriptors);
  }
  return 0;
}
