#pragma once

#include <memory>
#include <string>
#include <vector>

#include "frontend/sources/frame_source.h"
#include "frontend/sources/source_options.h"

namespace rgbd_pose {

// The kinds of recording that OpenSource accepts. The first is auto, which
// detects the kind. To add one, write a FrameSource and a row in
// open_source.cc.
std::vector<std::string> SourceNames();

// Opens a recording. Known depth errors of its camera are corrected in its
// frames. Throws InputError for an unknown name, for a path that is no
// recording of a known kind, and if the source cannot be opened.
std::unique_ptr<FrameSource> OpenSource(const std::string& name,
                                        const SourceOptions& options);

}  // namespace rgbd_pose
