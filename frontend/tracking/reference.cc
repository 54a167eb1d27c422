#include "frontend/tracking/reference.h"

#include <Eigen/Core>

#include "frontend/frame/image_pyramid.h"
#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// Distance between the samples that determine the overlap.
constexpr int kSampleStepPx = 20;

}  // namespace

Overlap ReferenceFeatures::SeenFrom(const Rigid3d& cur_from_ref) const {
  Overlap overlap;
  int seen = 0;
  for (const Observation& o : features->observations) {
    // Lens distortion does not matter here.
    const auto pixel = SeenAt(camera, cur_from_ref, o);
    if (!pixel.has_value() || !camera.Contains(*pixel)) continue;
    ++seen;
    overlap.flow_px += (*pixel - Eigen::Vector2d(o.u, o.v)).norm();
  }
  if (seen == 0) return overlap;
  overlap.share = static_cast<double>(seen) / features->observations.size();
  overlap.flow_px /= seen;
  return overlap;
}

ReferencePixels::ReferencePixels(const PreparedFrame& frame,
                                 const FrontendOptions& images, uint64_t id)
    : depth(frame.depth),
      pyramid(frame.Derived<SmoothPyramid>().levels),
      view(ViewFrame(frame, pyramid, images.camera, images.depth.noise)),
      samples(frame, images.camera, kSampleStepPx, images.depth.min_depth,
              images.depth.max_depth) {
  view.id = id;
}

}  // namespace rgbd_pose
