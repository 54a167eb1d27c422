#include "apps/results/cloud_preview.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace rgbd_pose {
namespace {

std::vector<uint8_t> FromBase64(const std::string& text) {
  const std::string digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<uint8_t> bytes;
  uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<uint32_t>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<uint8_t>(bits >> count));
  }
  return bytes;
}

// Decodes a preview as the page does.
std::vector<ColoredPoint> Decode(const nlohmann::json& preview) {
  const std::vector<uint8_t> steps = FromBase64(preview.at("positions"));
  const std::vector<uint8_t> colors = FromBase64(preview.at("colors"));
  std::vector<ColoredPoint> points(preview.at("points").get<size_t>());
  EXPECT_EQ(steps.size(), 6 * points.size());
  EXPECT_EQ(colors.size(), 3 * points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      const int number = steps[6 * i + 2 * k] + 256 * steps[6 * i + 2 * k + 1];
      points[i].position[static_cast<int>(k)] =
          static_cast<float>(preview.at("origin_m")[k].get<double>() +
                             preview.at("step_m").get<double>() * number);
    }
    for (size_t k = 0; k < 3; ++k) points[i].color[k] = colors[3 * i + k];
  }
  return points;
}

TEST(CloudPreviewTest, KeepsPlacesAndColoursOfAnyNumberOfPoints) {
  // Covers each length of the last group of base64.
  for (int count = 0; count <= 7; ++count) {
    std::vector<ColoredPoint> points;
    for (int i = 0; i < count; ++i) {
      ColoredPoint point;
      point.position = {1.0F + i, -2.0F * i, 0.25F};
      point.color = {static_cast<uint8_t>(250 + i),  // past 255
                     static_cast<uint8_t>(i), 128};
      points.push_back(point);
    }
    const std::vector<ColoredPoint> decoded = Decode(CloudPreview(points));
    ASSERT_EQ(decoded.size(), points.size());
    for (size_t i = 0; i < points.size(); ++i) {
      // Half a step of 12 m in 16 bits.
      EXPECT_LT((decoded[i].position - points[i].position).norm(), 2e-4F);
      EXPECT_EQ(decoded[i].color, points[i].color);
    }
  }
}

TEST(CloudPreviewTest, AMeshKeepsItsCorners) {
  TriangleMesh mesh;
  mesh.vertices.resize(300);  // indices need more than 8 bits
  mesh.vertices[299].position = {1.0F, 2.0F, 3.0F};
  mesh.triangles = {{0, 1, 299}, {299, 258, 2}};
  const nlohmann::json preview = MeshPreview(mesh);
  EXPECT_EQ(preview.at("points"), 300);
  EXPECT_EQ(preview.at("triangles"), 2);
  // 0 0 1 0 43 1 | 43 1 2 1 2 0, low bytes first.
  EXPECT_EQ(preview.at("corners"), "AAABACsBKwECAQIA");
}

}  // namespace
}  // namespace rgbd_pose
