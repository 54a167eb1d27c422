#pragma once

#include <memory>
#include <string>
#include <vector>

#include "frontend/sources/frame_source.h"
#include "frontend/sources/source_options.h"

namespace rgbd_pose {

// The kinds of recording that OpenSource takes; first auto: whatever it is. To
// add one, write a FrameSource and give it a row of the table in
// open_source.cc.
std::vector<std::string> SourceNames();

// Opens a recording; what its camera says is wrong with depth is undone in its
// frames. Throws InputError for an unknown name, for what is no
// recording of a known kind, and as the source does.
std::unique_ptr<FrameSource> OpenSource(const std::string& name,
                                        const SourceOptions& options);

}  // namespace rgbd_pose
