#include "frontend/bags/ros_messages.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

// A CompressedImage, byte by byte. CDR aligns each number to its size and ends
// each text with a 0.
constexpr char kCdr[] =
    "\x00\x01\x00\x00"  // little-endian CDR
    "\x02\x00\x00\x00"  // 2 s
    "\x00\x65\xcd\x1d"  // 500,000,000 ns
    "\x04\x00\x00\x00"
    "cam\0"  // frame
    "\x04\x00\x00\x00"
    "png\0"  // format
    "\x02\x00\x00\x00"
    "\x01\x02";
constexpr char kBigEndianCdr[] =
    "\x00\x00\x00\x00"
    "\x00\x00\x00\x02"
    "\x1d\xcd\x65\x00"
    "\x00\x00\x00\x03"
    "cm\0\0"  // padded
    "\x00\x00\x00\x04"
    "png\0"
    "\x00\x00\x00\x02"
    "\x01\x02";
constexpr char kRos1[] =
    "\x09\x00\x00\x00"  // counter
    "\x02\x00\x00\x00"
    "\x00\x65\xcd\x1d"
    "\x04\x00\x00\x00"
    "/cam"
    "\x03\x00\x00\x00"
    "png"
    "\x02\x00\x00\x00"
    "\x01\x02";

template <size_t N>
std::string_view BytesOf(const char (&literal)[N]) {
  return {literal, N - 1};
}

void ExpectRead(const WireReader& reader, std::string_view frame) {
  const RosImage image = ReadRosCompressedImage(reader);
  EXPECT_EQ(image.header.stamp, 2.5);
  EXPECT_EQ(image.header.frame_id, frame);
  EXPECT_EQ(image.encoding, "png");
  EXPECT_EQ(image.data, "\x01\x02");
  EXPECT_EQ(image.width, 0u);
}

TEST(RosMessagesTest, ReadsBytesAsTheStandardsSay) {
  ExpectRead(WireReader(BytesOf(kCdr), WireFormat::kCdr), "cam");
  ExpectRead(WireReader(BytesOf(kBigEndianCdr), WireFormat::kCdr), "cm");
  ExpectRead(WireReader(BytesOf(kRos1), WireFormat::kRos1), "cam");
}

TEST(RosMessagesTest, NumbersOfEightBytesAreAligned) {
  const std::string message =
      std::string("\x00\x01\x00\x00\x07\xee\xee\xee\xee\xee\xee\xee", 12) +
      std::string("\x00\x00\x00\x00\x00\x00\xf8\x3f", 8);  // 1.5
  WireReader reader(message, WireFormat::kCdr);
  EXPECT_EQ(reader.Number<uint8_t>(), 7);
  EXPECT_EQ(reader.Number<double>(), 1.5);
}

TEST(RosMessagesTest, RefusesWhatEndsTooEarly) {
  const std::string_view whole = BytesOf(kCdr);
  for (size_t size = 0; size < whole.size(); ++size) {
    ExpectInputError(
        [&] {
          ReadRosCompressedImage(
              WireReader(whole.substr(0, size), WireFormat::kCdr));
        },
        {"ends too early"});
  }
  ExpectInputError(
      [] {
        ReadRosTransforms(
            WireReader("\xff\xff\xff\xff nothing", WireFormat::kRos1));
      },
      {"a list of 4294967295 elements exceeds the rest"});
  ExpectInputError(
      [] { WireReader(std::string_view("\0\x03\0\0", 4), WireFormat::kCdr); },
      {"unknown encoding (CDR kind 3)"});
}

}  // namespace
}  // namespace rgbd_pose
