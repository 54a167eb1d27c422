#pragma once

#include <string>

#include "apps/view/view_state.h"

namespace rgbd_pose {

// Formats news as events for the browser (text/event-stream): always "news",
// and "end" after the last frame.
std::string FormatNews(const ViewNews& news);

// Formats images and matches as an event "images". Takes milliseconds.
std::string FormatImages(const ViewImages& images, int index);

}  // namespace rgbd_pose
