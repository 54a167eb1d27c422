#pragma once

#include <memory>
#include <string>

#include "apps/view/view_state.h"

namespace rgbd_pose {

// Serves a live page of a state to browsers on this machine, in its own
// threads: the page, its events and its buttons. Nothing is read from disk.
// Requests with another host name or from another page are refused.
class ViewServer {
 public:
  // `title` is the title of the page; port 0 means any free port. The state
  // must outlive this object. Throws InputError if it cannot listen on the
  // port.
  ViewServer(const std::string& title, int port, ViewState* state);
  // Sends the last news to open pages first.
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  // The address for a browser: "http://127.0.0.1:40123/"
  const std::string& address() const { return address_; }

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
  std::string address_;
};

}  // namespace rgbd_pose
