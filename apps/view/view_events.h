#pragma once

#include <string>

#include "apps/view/view_state.h"

namespace rgbd_pose {

// What is new as events for the browser (text/event-stream): "news" always,
// "end" after the last.
std::string FormatNews(const ViewNews& news);

// Images and matches as an event "images". Packing them takes milliseconds.
std::string FormatImages(const ViewImages& images, int index);

}  // namespace rgbd_pose
