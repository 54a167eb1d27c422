#include "frontend/files/exr_file.h"

#include "core/util/input_error.h"
#ifdef RGBD_POSE_HAS_OPENEXR
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <exception>

#include "frontend/frame/depth_resampling.h"
#endif

namespace rgbd_pose {

#ifdef RGBD_POSE_HAS_OPENEXR

namespace {

constexpr int kMostPixels = 1 << 26;  // of a file that is not damaged

cv::Mat ReadMetres(const std::string& path) {
  Imf::InputFile file(path.c_str(), /*numThreads=*/0);
  const Imf::ChannelList& channels = file.header().channels();
  auto channel = channels.begin();
  if (channel == channels.end()) throw InputError(path + ": has no channel");
  const std::string name = channel.name();
  if (++channel != channels.end()) {
    throw InputError(path + ": has more than one channel; depth has one");
  }
  const Imath::Box2i window = file.header().dataWindow();
  const int64_t width = int64_t{window.max.x} - window.min.x + 1;
  const int64_t height = int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width * height > kMostPixels) {
    throw InputError(path + ": has no plausible size");
  }
  cv::Mat metres(static_cast<int>(height), static_cast<int>(width), CV_32F,
                 cv::Scalar(0.0));
  // OpenEXR addresses pixels from (0, 0), wherever the window begins.
  char* const base = reinterpret_cast<char*>(metres.data) -
                     window.min.x * static_cast<ptrdiff_t>(sizeof(float)) -
                     window.min.y * static_cast<ptrdiff_t>(metres.step);
  Imf::FrameBuffer buffer;
  buffer.insert(name, Imf::Slice(Imf::FLOAT, base, sizeof(float), metres.step));
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return metres;
}

}  // namespace

cv::Mat ReadExrDepth(const std::string& path, double per_metre) {
  cv::Mat metres;
  try {
    metres = ReadMetres(path);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError(path + ": cannot be read as OpenEXR (" + error.what() +
                     ")");
  }
  cv::Mat raw(metres.size(), CV_16UC1);
  for (int v = 0; v < raw.rows; ++v) {
    const float* from = metres.ptr<float>(v);
    uint16_t* to = raw.ptr<uint16_t>(v);
    for (int u = 0; u < raw.cols; ++u) {
      to[u] = EncodeDepth(static_cast<float>(from[u] * per_metre));
    }
  }
  return raw;
}

#else

cv::Mat ReadExrDepth(const std::string& path, double /*per_metre*/) {
  throw InputError(
      path +
      ": this build cannot read OpenEXR files; install libopenexr-dev "
      "(scripts/install_dependencies formats) and build again");
}

#endif

}  // namespace rgbd_pose
