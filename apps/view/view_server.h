#pragma once

#include <memory>
#include <string>

#include "apps/view/view_state.h"

namespace rgbd_pose {

// Whether this program was built with the library that serves pages.
bool HasViewServer();

// Serves a live page of a state to browsers on this machine, in threads of its
// own: the page, its events, and its buttons. Nothing is read from disk; who
// asks for another host, or for another page's sake, is refused.
class ViewServer {
 public:
  // `title` is that of the page; port 0: one that is free. The state must
  // outlive it. Throws InputError if it cannot listen there.
  ViewServer(const std::string& title, int port, ViewState* state);
  // Pages that read get the last news first.
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  // For a browser: "http://127.0.0.1:40123/"
  std::string address() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rgbd_pose
