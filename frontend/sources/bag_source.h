#pragma once

#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "frontend/bags/bag_reader.h"
#include "frontend/bags/bag_topics.h"
#include "frontend/bags/transform_tree.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/frame_source.h"
#include "frontend/sources/image_pairing.h"
#include "frontend/sources/source_options.h"

namespace rgbd_pose {

// The frames of a bag, of ROS 1 or 2: colour and depth images paired by their
// stamps while they are read, so that only the frames under way are in memory.
// Its own camera is that of its CameraInfo.
class BagSource final : public FrameSource {
 public:
  // Throws InputError if it has no colour or no depth images, or does not say
  // what camera it was and the options do not, either.
  BagSource(std::unique_ptr<BagReader> bag, const SourceOptions& options);

  // Throws InputError, too, if no two images belong together at all; where the
  // bag is damaged, after the frames before that. A damaged message is a frame
  // that cannot be read.
  std::optional<RgbdFrame> Next() override;
  const RgbdCamera& camera() const override { return assembly_.camera(); }

  // What /tf has said so far of how the colour camera moved in the frame
  // `world`, as a motion capture system publishes it.
  Trajectory ground_truth() const override;
  int unmatched_color() const override { return pairing_.unmatched_color(); }
  std::vector<std::string> remarks() const override;

 private:
  // Reads on: whether there was anything more.
  bool ReadOn();
  void Add(const BagMessage& message);
  RgbdFrame MakeFrame(const StampedPair& pair);
  std::string NameOf(int topic, double stamp) const;

  std::unique_ptr<BagReader> bag_;
  BagTopics topics_;
  double max_time_difference_;
  std::string color_frame_;  // of reference
  std::string depth_frame_;
  FrameAssembly assembly_;
  ImagePairing pairing_;
  TransformTree transforms_;
  int num_color_ = 0;
  int num_depth_ = 0;
  int num_frames_ = 0;
  double first_color_ = 0.0;  // stamps, s
  double first_depth_ = 0.0;
  double last_stamp_ = 0.0;    // of a frame
  std::exception_ptr damage_;  // of the last message
  std::exception_ptr error_;   // of the bag
  bool is_read_ = false;       // to its end
  bool is_over_ = false;
};

}  // namespace rgbd_pose
