#include "frontend/files/png_decoder.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/util/text_file.h"
#include "tests/support/png_parts.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

constexpr int kPngWidth = 31;
constexpr int kPngHeight = 23;

// Random bytes, which are an image under every filter. Filters alternate unless
// one is given.
std::string RandomRows(int row_bytes, int filter = -1) {
  cv::RNG rng(7);
  std::string rows;
  for (int y = 0; y < kPngHeight; ++y) {
    rows += static_cast<char>(filter < 0 ? y % 5 : filter);
    for (int i = 0; i < row_bytes; ++i) rows += static_cast<char>(rng.next());
  }
  return rows;
}

PngParts Parts(char bits, char color_type, int row_bytes, int filter) {
  const std::string kind = {bits, color_type, 0, 0, 0};
  return {kPngWidth, kPngHeight, kind, "", RandomRows(row_bytes, filter)};
}
PngParts Color(int filter = -1) { return Parts(8, 2, 3 * kPngWidth, filter); }
PngParts Gray(int filter = -1) { return Parts(8, 0, kPngWidth, filter); }
PngParts Depth(int filter = -1) { return Parts(16, 0, 2 * kPngWidth, filter); }

cv::Mat DecodeByOpenCv(std::string file, int flags) {
  return cv::imdecode(
      cv::Mat(1, static_cast<int>(file.size()), CV_8UC1, file.data()), flags);
}

cv::Mat AsGray(const std::string& file) {
  return DecodePng(file, PngUse::kGray).image;
}

cv::Mat AsDepth(const std::string& file) {
  return DecodePng(file, PngUse::kDepth).image;
}

// Whether damage of the file is found in any use.
bool IsDamaged(const std::string& file) {
  return DecodePng(file, PngUse::kGray).is_damaged ||
         DecodePng(file, PngUse::kDepth).is_damaged;
}

// Expects exactly OpenCV's result for a file.
void ExpectAsOpenCv(const cv::Mat& decoded, const std::string& file,
                    int flags) {
  const cv::Mat expected = DecodeByOpenCv(file, flags);
  ASSERT_FALSE(expected.empty());
  ASSERT_EQ(decoded.size(), expected.size());
  ASSERT_EQ(decoded.type(), expected.type());
  EXPECT_EQ(cv::norm(decoded, expected, cv::NORM_INF), 0.0);
}

// Expects OpenCV's conversion of the colours; its PNG decoder does not round.
void ExpectGray(const cv::Mat& decoded, const std::string& file) {
  cv::Mat expected;
  cv::cvtColor(DecodeByOpenCv(file, cv::IMREAD_COLOR), expected,
               cv::COLOR_BGR2GRAY);
  ASSERT_EQ(decoded.size(), expected.size());
  EXPECT_EQ(cv::norm(decoded, expected, cv::NORM_INF), 0.0);
}

void ExpectGrayAsOpenCv(const std::string& file) {
  ExpectGray(AsGray(file), file);
}
void ExpectDepthAsOpenCv(const std::string& file) {
  ExpectAsOpenCv(AsDepth(file), file, cv::IMREAD_UNCHANGED);
}

void ExpectLeft(const std::string& file) {
  EXPECT_TRUE(AsGray(file).empty());
  EXPECT_TRUE(AsDepth(file).empty());
}

TEST(PngDecoderTest, UndoesEveryFilterAsOpenCvDoes) {
  for (int filter = -1; filter < 5; ++filter) {
    SCOPED_TRACE(filter);
    ExpectGrayAsOpenCv(Color(filter).File());
    ExpectGrayAsOpenCv(Gray(filter).File());
    ExpectDepthAsOpenCv(Depth(filter).File());
  }
}

TEST(PngDecoderTest, GivesColoursToo) {
  for (const PngParts& parts : {Color(), Gray()}) {
    const std::string file = parts.File();
    const DecodedPng decoded = DecodePng(file, PngUse::kGrayAndColor);
    ExpectGray(decoded.image, file);
    ExpectAsOpenCv(decoded.color, file, cv::IMREAD_COLOR);
    EXPECT_TRUE(DecodePng(file, PngUse::kGray).color.empty());
  }
}

TEST(PngDecoderTest, ReadsWhatOpenCvWrites) {
  const TempFolder folder;
  for (const int type : {CV_8UC3, CV_16UC1}) {
    for (const bool smallest : {false, true}) {
      cv::Mat image(480, 640, type);
      cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 65536);
      cv::blur(image, image, {9, 9});  // compressible
      std::vector<int> options;
      if (smallest) options = {cv::IMWRITE_PNG_COMPRESSION, 9};
      ASSERT_TRUE(cv::imwrite(folder / "image.png", image, options));
      const std::string file = ReadTextFile(folder / "image.png");
      if (type == CV_8UC3) {
        ExpectGrayAsOpenCv(file);
      } else {
        ExpectDepthAsOpenCv(file);
      }
    }
  }
}

TEST(PngDecoderTest, TakesDepthFromTheUpperByteFirst) {
  PngParts parts = Depth(0);
  parts.rows.replace(0, 5, std::string("\0\x01\x02\xFF\xFE", 5));
  const cv::Mat depth = AsDepth(parts.File());
  EXPECT_EQ(depth.at<uint16_t>(0, 0), 0x0102);
  EXPECT_EQ(depth.at<uint16_t>(0, 1), 0xFFFE);
}

TEST(PngDecoderTest, SkipsChunksThatLeaveThePixelsAlone) {
  PngParts parts = Color();
  parts.before_image = Chunk("tEXt", std::string("Comment\0kitchen", 15)) +
                       Chunk("tIME", "\x07\xE8\x01\x01\x0C\x01\x01");
  ExpectGrayAsOpenCv(parts.File());
  ExpectGrayAsOpenCv(Color().File() + "more behind the end");
}

TEST(PngDecoderTest, LeavesOtherKindsToOpenCv) {
  EXPECT_TRUE(AsDepth(Color().File()).empty());
  EXPECT_TRUE(AsGray(Depth().File()).empty());
  EXPECT_TRUE(AsDepth(Gray().File()).empty());
  PngParts deep = Color();
  deep.kind[0] = 16;
  deep.rows = RandomRows(6 * kPngWidth);
  ExpectLeft(deep.File());
}

// Only OpenCV decompresses these rows; this decoder does not check them.
TEST(PngDecoderTest, DoesNotDecompressWhatIsLeftToOpenCv) {
  PngParts palette = Gray();
  palette.kind[1] = 3;
  PngParts gamma = Color();
  gamma.before_image = Chunk("gAMA", BigEndian(45455));
  for (PngParts parts : {palette, gamma}) {
    parts.rows.resize(kPngWidth);  // the other rows are missing
    EXPECT_FALSE(IsDamaged(parts.File()));
  }
}

TEST(PngDecoderTest, LeavesColorSpacesToOpenCv) {
  PngParts parts = Color();
  parts.before_image = Chunk("gAMA", BigEndian(45455));
  ExpectLeft(parts.File());
  parts.before_image = Chunk("tRNS", std::string(6, '\0'));
  ExpectLeft(parts.File());
}

TEST(PngDecoderTest, KnowsADamagedFileAndLeavesItToOpenCv) {
  const std::string good = Color().File();
  ASSERT_FALSE(AsGray(good).empty());
  EXPECT_FALSE(IsDamaged(good));
  EXPECT_FALSE(IsDamaged(good + "more behind the end"));
  EXPECT_FALSE(IsDamaged("no PNG at all"));
  EXPECT_FALSE(IsDamaged(""));
  constexpr size_t kSignature = 8;
  for (size_t i = 0; i < good.size(); ++i) {
    std::string changed = good;
    changed[i] ^= 1;
    for (const std::string& file : {changed, good.substr(0, i)}) {
      ExpectLeft(file);
      EXPECT_EQ(IsDamaged(file), i >= kSignature) << i;
    }
  }
}

// As in libpng, chunks that are not needed may be damaged.
TEST(PngDecoderTest, ADamagedCommentIsNoDamage) {
  PngParts parts = Color();
  parts.before_image = Chunk("tEXt", std::string("Comment\0kitchen", 15));
  parts.before_image.back() ^= 1;
  EXPECT_FALSE(IsDamaged(parts.File()));
  ExpectLeft(parts.File());
}

// Files with valid checksums and invalid content.
TEST(PngDecoderTest, LeavesContradictoryFilesToOpenCv) {
  PngParts parts = Color();
  parts.rows.pop_back();
  ExpectLeft(parts.File());
  parts.rows += "ab";  // one byte too many
  ExpectLeft(parts.File());
  ExpectLeft(Color(5).File());  // an unknown filter

  parts = Color();
  for (const uint32_t width : {0u, kPngWidth - 1u, 1u << 30, 0xFFFFFFFFu}) {
    parts.width = width;
    ExpectLeft(parts.File());
  }
  parts = Color();
  parts.kind[4] = 1;  // interlaced
  ExpectLeft(parts.File());

  const std::string good = Color().File();
  const std::string header = Color().Header();
  const std::string signature = good.substr(0, 8);
  ExpectLeft(signature + good.substr(8 + header.size()));
  ExpectLeft(signature + header + good.substr(8));
}

// Damage that libpng would report on stderr.
TEST(PngDecoderTest, FindsDamageWithoutWrongChecksums) {
  PngParts parts = Depth();
  EXPECT_FALSE(IsDamaged(parts.File()));
  parts.rows.pop_back();
  EXPECT_TRUE(IsDamaged(parts.File())) << "a byte is missing";
  parts = Depth(4);
  parts.rows[2 * kPngWidth + 1] = 5;
  EXPECT_TRUE(IsDamaged(parts.File())) << "no such filter";
  parts = Depth();
  parts.kind[1] = 5;
  EXPECT_TRUE(IsDamaged(parts.File())) << "no such kind of colour";
  parts = Depth();
  parts.width = parts.height = 16384;  // memory for this must not be allocated
  EXPECT_TRUE(IsDamaged(parts.File()));
  parts.width = 16385;
  EXPECT_TRUE(IsDamaged(parts.File()));
}

}  // namespace
}  // namespace rgbd_pose
