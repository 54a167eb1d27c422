#include "apps/view/view_server.h"

#include "core/util/format.h"
#include "core/util/input_error.h"

#ifdef RGBD_POSE_HAS_HTTPLIB
#include <httplib.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/report/report_page.h"
#endif

namespace rgbd_pose {

#ifdef RGBD_POSE_HAS_HTTPLIB
namespace {

using std::chrono::milliseconds;

constexpr char kHost[] = "127.0.0.1";

// Each open page occupies a thread; further pages are refused.
constexpr int kMaxReaders = 12;
constexpr size_t kThreads = kMaxReaders + 4;

// Minimum interval between events: encoding images takes time from tracking.
constexpr milliseconds kInterval(80);
// Interval of events without news. They detect pages that have been closed.
constexpr milliseconds kHeartbeat(500);

// In seconds. Only the page's own thread waits for a browser that does not
// read.
constexpr int kWriteTimeout = 2;

// Maximum time for sending the last news to the pages.
constexpr milliseconds kFarewell(1500);

// A self-contained page that only requests events from its server.
std::string ViewPage(const std::string& title) {
  const ReportAssets assets = EmbeddedReportAssets();
  return FillPage(assets.view_page,
                  {{"%STYLE%", std::string(assets.view_style)},
                   {"%DATA%", InlineData({{"title", title}})},
                   {"%SCRIPT%", std::string(assets.view_script)}});
}

}  // namespace

class ViewServer::Impl {
 public:
  Impl(const std::string& title, int port, ViewState* state)
      : state_(state), page_(ViewPage(title)) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    // Replaces the default SO_REUSEPORT: a port must belong to one program.
    server_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    });
    server_.set_tcp_nodelay(true);
    server_.set_write_timeout(kWriteTimeout);
    server_.set_read_timeout(kWriteTimeout);
    server_.set_keep_alive_timeout(1);
    server_.set_payload_max_length(1024);
    server_.set_default_headers(
        {{"Cache-Control", "no-store"},
         {"X-Content-Type-Options", "nosniff"},
         {"Referrer-Policy", "no-referrer"},
         {"Content-Security-Policy",
          "default-src 'none'; style-src 'unsafe-inline'; script-src "
          "'unsafe-inline'; img-src data:; connect-src 'self'; "
          "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"}});
    Route();
    port_ = port == 0 ? server_.bind_to_any_port(kHost)
            : server_.bind_to_port(kHost, port) ? port
                                                : -1;
    if (port_ <= 0) {
      throw InputError("view_port=" + std::to_string(port) +
                       ": cannot listen on this port; another program may use "
                       "it (0: any free port)");
    }
    thread_ = std::thread([this] {
      server_.listen_after_bind();
      has_ended_ = true;
    });
  }

  ~Impl() {
    const auto end = std::chrono::steady_clock::now() + kFarewell;
    while (state_->readers() > 0 && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(milliseconds(10));
    }
    is_closing_ = true;
    // The server can only be stopped once it is listening.
    while (!server_.is_running() && !has_ended_) std::this_thread::yield();
    server_.stop();
    thread_.join();
  }

  int port() const { return port_; }

 private:
  using Request = httplib::Request;
  using Response = httplib::Response;

  void Route() {
    server_.set_pre_routing_handler(
        [this](const Request& request, Response& response) {
          if (IsOurs(request))
            return httplib::Server::HandlerResponse::Unhandled;
          response.status = 403;
          response.set_content("unknown host or origin\n", "text/plain");
          return httplib::Server::HandlerResponse::Handled;
        });
    server_.Get("/", [this](const Request&, Response& response) {
      response.set_content(page_, "text/html; charset=utf-8");
    });
    server_.Get("/events", [this](const Request&, Response& response) {
      ServeEvents(&response);
    });
    const auto button = [this](const char* path, auto press) {
      server_.Post(path, [press](const Request&, Response& response) {
        press();
        response.set_content("ok\n", "text/plain");
      });
    };
    button("/pause", [this] { state_->Pause(true); });
    button("/resume", [this] { state_->Pause(false); });
    button("/stop", [this] { state_->Stop(); });
  }

  // Rejects the requests of other sites: those with a host name of theirs, or
  // from a page of theirs.
  bool IsOurs(const Request& request) const {
    // Browsers leave out the usual port.
    const std::string port = port_ == 80 ? "" : ":" + std::to_string(port_);
    const std::string host = request.get_header_value("Host");
    if (host != kHost + port && host != "localhost" + port) return false;
    return !request.has_header("Origin") ||
           request.get_header_value("Origin") == "http://" + host;
  }

  void ServeEvents(Response* response) {
    if (state_->readers() >= kMaxReaders) {
      response->status = 503;
      response->set_content("too many pages are open\n", "text/plain");
      return;
    }
    state_->AddReaders(1);
    auto cursor = std::make_shared<ViewCursor>();
    response->set_chunked_content_provider(
        "text/event-stream",
        [this, cursor](size_t, httplib::DataSink& sink) {
          return SendNext(cursor.get(), &sink);
        },
        [this](bool) { state_->AddReaders(-1); });
  }

  // Returns false to end the connection.
  bool SendNext(ViewCursor* cursor, httplib::DataSink* sink) {
    if (is_closing_) return false;
    const ViewNews news = state_->Next(kHeartbeat, cursor);
    std::string events = FormatNews(news);
    if (news.images.has_value()) events += Images(news);
    if (!sink->write(events.data(), events.size())) return false;
    if (news.is_finished) {
      sink->done();
      return true;
    }
    std::this_thread::sleep_for(kInterval);
    return true;
  }

  // The images are encoded once for all pages.
  std::string Images(const ViewNews& news) {
    const std::lock_guard<std::mutex> lock(images_mutex_);
    if (news.images_index > packed_index_) {
      packed_ = FormatImages(*news.images, news.images_index);
      packed_index_ = news.images_index;
    }
    return packed_;
  }

  ViewState* const state_;
  const std::string page_;
  httplib::Server server_;
  int port_ = 0;
  std::atomic<bool> is_closing_{false};
  std::atomic<bool> has_ended_{false};
  std::mutex images_mutex_;
  std::string packed_;
  int packed_index_ = -1;
  std::thread thread_;
};

ViewServer::ViewServer(const std::string& title, int port, ViewState* state)
    : impl_(std::make_unique<Impl>(title, port, state)),
      address_(Format("http://%s:%d/", kHost, impl_->port())) {}

#else

class ViewServer::Impl {};

ViewServer::ViewServer(const std::string&, int, ViewState*) {
  throw InputError(
      "no live page: built without cpp-httplib; install libcpp-httplib-dev "
      "(scripts/install_dependencies) and build again");
}

#endif

ViewServer::~ViewServer() = default;

}  // namespace rgbd_pose
