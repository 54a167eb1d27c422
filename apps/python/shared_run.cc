#include "apps/python/shared_run.h"

#include "apps/python/released_gil.h"
#include "apps/python/tracker_bindings.h"

namespace rgbd_pose {

std::string SharedRun::OpenView(const std::string& title,
                                const ViewSettings& settings) {
  const std::lock_guard<std::mutex> lock(mutex_);
  view_.reset();  // frees its port
  view_ = std::make_unique<LiveView>(title, settings, camera_.camera, run_);
  return view_->address();
}

void SharedRun::CloseView() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (view_ != nullptr) view_->Finish("");
}

bool SharedRun::IsStopped() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return view_ != nullptr && view_->is_stopped();
}

void SharedRun::Add(Frame frame, std::optional<double> timestamp,
                    const Rigid3d* guess) {
  StampFrame(timestamp, run_.frames().empty() ? nullptr : &run_.frames().back(),
             &frame);
  run_.Add(PreparedFrame(frame), guess);
  if (view_ == nullptr) return;
  view_->Add(frame, [] {
    ThrowIfInterrupted();
    return false;
  });
}

}  // namespace rgbd_pose
