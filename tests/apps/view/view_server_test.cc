#include "apps/view/view_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <chrono>
#include <string>
#include <thread>

#include "apps/view/view_state.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using testing::HasSubstr;
using testing::Not;

// Longer than any response takes on a busy machine.
constexpr std::chrono::seconds kPatience(10);

// If Add() waited for a reader, it would wait for the timeout of 2 s. A busy
// machine may delay it by a part of a second.
constexpr milliseconds kMaxAdd(1000);

ViewNews OneFrame(int index) {
  ViewNews news;
  ViewFrame frame;
  frame.timestamp = index / 30.0;
  frame.status = TrackingStatus::kDegraded;
  frame.reason = "only 12 of 34 matches agree";
  frame.matches = 34;
  frame.keyframe = 0;
  frame.keyframe_from_cam.translation.x() = 0.001 * index;
  news.frames.push_back(frame);
  if (index == 0) {
    news.keyframes.push_back({0, std::string(kViewPointBytes, 'p')});
    news.poses[0] = Rigid3d();
  }
  ViewImages images;
  images.gray = cv::Mat(480, 640, CV_8UC1, cv::Scalar(100));
  images.depth = cv::Mat(480, 640, CV_16UC1, cv::Scalar(10000));
  images.moves.emplace_back(1, 2, 3, 4, 0.5F);
  news.images = images;
  return news;
}

class ViewServerTest : public testing::Test {
 protected:
  static int PortOf(const ViewServer& server) {
    const std::string& address = server.address();
    return std::stoi(address.substr(address.rfind(':') + 1));
  }

  // Reads events until all `words` have come (each once, in order) or kPatience
  // has passed; returns the text read.
  static std::string ReadUntil(int port,
                               const std::vector<std::string>& words) {
    httplib::Client client("127.0.0.1", port);
    client.set_read_timeout(kPatience.count());
    std::string text;
    const auto end = steady_clock::now() + kPatience;
    client.Get("/events", [&](const char* data, size_t size) {
      text.append(data, size);
      size_t at = 0;
      for (const std::string& word : words) {
        at = text.find(word, at);
        if (at == std::string::npos) return steady_clock::now() < end;
      }
      return false;
    });
    return text;
  }

  template <typename Condition>
  static bool Eventually(const Condition& condition) {
    const auto end = steady_clock::now() + kPatience;
    while (!condition()) {
      if (steady_clock::now() > end) return false;
      std::this_thread::sleep_for(milliseconds(5));
    }
    return true;
  }

  ViewState state_;
};

TEST_F(ViewServerTest, ServesThePageAloneAndToItsOwnHostAlone) {
  const ViewServer server("a <b> recording", 0, &state_);
  const int port = PortOf(server);
  EXPECT_EQ(server.address(), "http://127.0.0.1:" + std::to_string(port) + "/");
  httplib::Client client("127.0.0.1", port);
  const auto page = client.Get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_THAT(page->body, HasSubstr("a \\u003cb> recording"));
  EXPECT_THAT(page->body, Not(HasSubstr("<script src")));
  EXPECT_THAT(page->get_header_value("Content-Security-Policy"),
              HasSubstr("default-src 'none'"));
  for (const std::string path :
       {"/etc/passwd", "/../../etc/passwd", "/index.html", "//etc/passwd"}) {
    EXPECT_EQ(client.Get(path)->status, 404) << path;
  }

  // Another host name that resolves to this machine, and a page of another
  // site.
  const httplib::Headers kRefused[] = {
      {{"Host", "evil.example"}},
      {{"Host", "127.0.0.1"}},
      {{"Host", "127.0.0.1:1"}},
      {{"Host", "127.0.0.1:" + std::to_string(port)},
       {"Origin", "http://evil.example"}}};
  for (const httplib::Headers& headers : kRefused) {
    EXPECT_EQ(client.Get("/", headers)->status, 403);
    EXPECT_EQ(client.Get("/events", headers)->status, 403);
    EXPECT_EQ(client.Post("/stop", headers, "", "text/plain")->status, 403);
  }
  EXPECT_FALSE(state_.is_stopped());
}

TEST_F(ViewServerTest, TellsAllFromTheStartToWhoeverComes) {
  const ViewServer server("run", 0, &state_);
  for (int i = 0; i < 3; ++i) state_.Add(OneFrame(i));
  for (int page = 0; page < 2; ++page) {
    const std::string events = ReadUntil(
        PortOf(server),
        {"event: news\ndata: {\"frames\":[[0.000,1,", "[0.033,", "[0.067,",
         "\"keyframes\":[[0,\"cHBwcHBwcA==\"]]", "\"poses\":[[0,0.0000,",
         "event: images", "\"gray\":\"/9j/", "\"depth\":\"iVBOR",
         "\"matches\":[[1.0,2.0,3.0,4.0,0.50]]"});
    EXPECT_THAT(events, HasSubstr("only 12 of 34 matches agree"));
    EXPECT_THAT(events, HasSubstr("[[1.0,2.0,3.0,4.0,0.50]]"));
  }
  EXPECT_TRUE(Eventually([&] { return state_.readers() == 0; }));
}

TEST_F(ViewServerTest, AnOpenPageHearsOfEachFrameAndOfTheEnd) {
  std::string events;
  std::thread reader;
  {
    const ViewServer server("run", 0, &state_);
    reader = std::thread([&, port = PortOf(server)] {
      events = ReadUntil(port, {"event: end"});
    });
    ASSERT_TRUE(Eventually([&] { return state_.readers() == 1; }));
    for (int i = 0; i < 30; ++i) {
      state_.Add(OneFrame(i));
      std::this_thread::sleep_for(milliseconds(10));
    }
    state_.Finish("runs/here");
  }
  reader.join();
  for (int i = 0; i < 30; ++i) {
    char start[32];
    std::snprintf(start, sizeof(start), "[%.3f,1,", i / 30.0);
    EXPECT_THAT(events, HasSubstr(start));
  }
  EXPECT_THAT(events, HasSubstr("event: end\ndata: \"runs/here\""));
}

TEST_F(ViewServerTest, ButtonsPauseAndStop) {
  const ViewServer server("run", 0, &state_);
  httplib::Client client("127.0.0.1", PortOf(server));
  EXPECT_EQ(client.Get("/pause")->status, 404);
  ASSERT_EQ(client.Post("/pause")->status, 200);
  EXPECT_TRUE(state_.is_paused());
  EXPECT_THAT(ReadUntil(PortOf(server), {"\"paused\":true"}),
              HasSubstr("\"paused\":true"));
  ASSERT_EQ(client.Post("/resume")->status, 200);
  EXPECT_FALSE(state_.is_paused());
  ASSERT_EQ(client.Post("/pause")->status, 200);
  ASSERT_EQ(client.Post("/stop")->status, 200);
  EXPECT_FALSE(state_.is_paused());
  EXPECT_TRUE(state_.is_stopped());
}

// The reader's socket fills up and the reader is dropped; Add() never waits.
TEST_F(ViewServerTest, AReaderThatNeverReadsSlowsNobody) {
  const ViewServer server("run", 0, &state_);
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  const int small = 1024;
  setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &small, sizeof(small));
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(PortOf(server)));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(
      connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof(address)),
      0);
  const std::string request = "GET /events HTTP/1.1\r\nHost: 127.0.0.1:" +
                              std::to_string(PortOf(server)) + "\r\n\r\n";
  ASSERT_EQ(send(socket, request.data(), request.size(), 0),
            static_cast<ssize_t>(request.size()));
  ASSERT_TRUE(Eventually([&] { return state_.readers() == 1; }));
  ViewNews large = OneFrame(0);
  large.frames.resize(2000);
  for (ViewFrame& frame : large.frames) frame.reason.assign(1000, 'x');
  steady_clock::duration longest{};
  int index = 0;
  const auto add = [&] {
    ViewNews news = index++ % 8 == 0 ? large : OneFrame(index);
    const auto start = steady_clock::now();
    state_.Add(std::move(news));
    longest = std::max(longest, steady_clock::now() - start);
    return state_.readers() == 0;
  };
  EXPECT_TRUE(Eventually(add)) << "is never let go";
  EXPECT_LT(longest, kMaxAdd);
  // Other readers are served during and after this.
  EXPECT_THAT(ReadUntil(PortOf(server), {"event: news"}),
              HasSubstr("event: news"));
  close(socket);
}

TEST_F(ViewServerTest, APortThatIsTakenIsSaid) {
  const ViewServer server("run", 0, &state_);
  try {
    const ViewServer other("run", PortOf(server), &state_);
    FAIL() << "took it twice";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("view_port=" + std::to_string(PortOf(server)) +
                          ": cannot listen on this port"));
  }
}

}  // namespace
}  // namespace rgbd_pose
