#include "frontend/simulation/synthetic_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/geometry/twist.h"
#include "frontend/simulation/synthetic_texture.h"

namespace rgbd_pose {

// A face as seen by a camera. For the ray (x, y, 1) of a pixel in camera axes,
// face_from_ray * ray = (u, v, 1) / z: (u, v) is where the ray meets the plane
// of the face, z the depth there. This is linear in the ray, and the search for
// the nearest face takes only multiplications and comparisons.
struct VisibleFace {
  const SceneFace* face = nullptr;
  Eigen::Matrix3f face_from_ray;
  Eigen::Vector3f lamp;       // position along u, along v, above the face (m)
  Eigen::Vector3f camera;     // in the same axes
  Eigen::AlignedBox2f range;  // on the plane z = 1, see RangeOf
};

namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3f;
using Eigen::Vector2f;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kTileSize = SurfacePoints::kMost;
// Faces extend this far (m) beyond their edges, against cracks by rounding.
constexpr float kOverlap = 1e-4f;
// Blur of the lens and of the colour filter mosaic (sigma, px).
constexpr double kLensBlur = 0.6;

// Where the rays (x, y, 1) of neighbouring pixels meet a face at depths z (m),
// and the extent of a pixel there, in a loop that the compiler vectorises.
void Meet(const Matrix3f& face_from_ray, const float* x, const float* y,
          const float* z, const Vector2f& pixel, SurfacePoints* at) {
  const float* const h = face_from_ray.data();  // column by column
  for (int k = 0; k < at->size; ++k) {
    const float u = (h[0] * x[k] + (h[3] * y[k] + h[6])) * z[k];
    const float v = (h[1] * x[k] + (h[4] * y[k] + h[7])) * z[k];
    // The derivative of a quotient, times the size of the pixel.
    const float u_by_x = (h[0] - u * h[2]) * z[k] * pixel.x();
    const float u_by_y = (h[3] - u * h[5]) * z[k] * pixel.y();
    const float v_by_x = (h[1] - v * h[2]) * z[k] * pixel.x();
    const float v_by_y = (h[4] - v * h[5]) * z[k] * pixel.y();
    at->u[k] = u;
    at->v[k] = v;
    at->footprint_u[k] = std::sqrt(u_by_x * u_by_x + u_by_y * u_by_y);
    at->footprint_v[k] = std::sqrt(v_by_x * v_by_x + v_by_y * v_by_y);
  }
}

// The brightness of a surface in the light of the lamp and of the room.
float Brightness(const Vector3f& to_lamp) {
  constexpr float kAmbient = 0.60f;
  constexpr float kLamp = 0.85f;
  constexpr float kHalfDistance2 = 6.0f;  // m^2
  const float distance2 = to_lamp.squaredNorm() + 1e-6f;
  const float cosine = std::max(0.0f, to_lamp.z()) / std::sqrt(distance2);
  return kAmbient + kLamp * cosine / (1.0f + distance2 / kHalfDistance2);
}

// The lamp's reflection on a glossy surface (Blinn 1977). It moves with the
// camera, unlike any surface.
float Highlight(const Vector3f& to_lamp, const Vector3f& to_camera) {
  constexpr float kSharpness = 40.0f;
  const Vector3f half = to_lamp.normalized() + to_camera.normalized();
  return std::pow(std::max(0.0f, half.normalized().z()), kSharpness);
}

// The range of a face on the plane z = 1: infinite if it reaches behind the
// camera, empty if it is entirely there.
Eigen::AlignedBox2f RangeOf(const SceneFace& face, const Vector3d& camera,
                            const Matrix3d& cam_from_world_rotation) {
  constexpr double kNearPlane = 0.01;  // m
  constexpr float kEndless = std::numeric_limits<float>::max();
  Eigen::AlignedBox2f range;
  bool is_partly_behind = false;
  for (int corner = 0; corner < 4; ++corner) {
    const double u = (corner & 1) == 0 ? 0.0 : face.width;
    const double v = (corner & 2) == 0 ? 0.0 : face.height;
    const Vector3d in_cam =
        cam_from_world_rotation *
        (face.origin + face.u_axis * u + face.v_axis * v - camera);
    if (in_cam.z() < kNearPlane) {
      is_partly_behind = true;
    } else {
      range.extend((in_cam.head<2>() / in_cam.z()).cast<float>());
    }
  }
  if (is_partly_behind && !range.isEmpty()) {
    range = {Vector2f::Constant(-kEndless), Vector2f::Constant(kEndless)};
  }
  return range;
}

// A point along u, along v and above the face (m).
Vector3d InFaceAxes(const SceneFace& face, const Vector3d& point) {
  const Vector3d from_origin = point - face.origin;
  return {face.u_axis.dot(from_origin), face.v_axis.dot(from_origin),
          face.normal.dot(from_origin)};
}

// Appends the faces of a scene whose front is turned to the camera and which
// are not entirely behind it. They point into `scene`.
void AddVisibleFaces(const Scene& scene, const Rigid3d& world_from_cam,
                     std::vector<VisibleFace>* faces) {
  const Matrix3d cam_from_world_rotation =
      world_from_cam.rotation.conjugate().toRotationMatrix();
  for (const SceneFace& face : scene.faces) {
    const Vector3d camera = InFaceAxes(face, world_from_cam.translation);
    if (camera.z() <= 0.0) continue;
    VisibleFace visible;
    visible.range =
        RangeOf(face, world_from_cam.translation, cam_from_world_rotation);
    if (visible.range.isEmpty()) continue;
    // A ray r meets the plane at depth z where camera.z + z normal . r = 0.
    Matrix3d rows;
    rows.row(2) = -(cam_from_world_rotation * face.normal) / camera.z();
    rows.row(0) = (cam_from_world_rotation * face.u_axis).transpose() +
                  camera.x() * rows.row(2);
    rows.row(1) = (cam_from_world_rotation * face.v_axis).transpose() +
                  camera.y() * rows.row(2);
    visible.face = &face;
    visible.face_from_ray = rows.cast<float>();
    visible.lamp = InFaceAxes(face, scene.lamp).cast<float>();
    visible.camera = camera.cast<float>();
    faces->push_back(visible);
  }
}

// For each pixel of a tile, row by row: the inverse depth of the nearest face
// and its index; 0 and -1 if there is none.
struct NearestFaces {
  std::array<float, kTileSize* kTileSize> inverse_depth = {};
  std::array<int, kTileSize * kTileSize> index;
};

// `range`: of the rays of the tile on the plane z = 1.
NearestFaces FindNearest(const std::vector<VisibleFace>& faces,
                         const Eigen::AlignedBox2f& range,
                         const cv::Mat& rays_x, const cv::Mat& rays_y) {
  NearestFaces nearest;
  nearest.index.fill(-1);
  for (int i = 0; i < static_cast<int>(faces.size()); ++i) {
    if (!faces[i].range.intersects(range)) continue;
    const Matrix3f h = faces[i].face_from_ray;
    const float width = static_cast<float>(faces[i].face->width) + kOverlap;
    const float height = static_cast<float>(faces[i].face->height) + kOverlap;
    const int columns = rays_x.cols;
    for (int row = 0; row < rays_x.rows; ++row) {
      const float* x = rays_x.ptr<float>(row);
      const float* y = rays_y.ptr<float>(row);
      float* best = nearest.inverse_depth.data() + row * kTileSize;
      int* index = nearest.index.data() + row * kTileSize;
      // Without branches and divisions, the compiler vectorises this loop.
      for (int column = 0; column < columns; ++column) {
        const float u = h(0, 0) * x[column] + h(0, 1) * y[column] + h(0, 2);
        const float v = h(1, 0) * x[column] + h(1, 1) * y[column] + h(1, 2);
        const float w = h(2, 0) * x[column] + h(2, 1) * y[column] + h(2, 2);
        const bool hit = (w > best[column]) & (u >= -kOverlap * w) &
                         (u <= width * w) & (v >= -kOverlap * w) &
                         (v <= height * w);
        best[column] = hit ? w : best[column];
        index[column] = hit ? i : index[column];
      }
    }
  }
  return nearest;
}

}  // namespace

Renderer::Renderer(Scene scene, const Camera& camera,
                   std::vector<SyntheticMover> movers)
    : scene_(std::move(scene)),
      movers_(std::move(movers)),
      rays_x_(camera.height, camera.width, CV_32FC1),
      rays_y_(camera.height, camera.width, CV_32FC1),
      pixel_(1.0 / camera.fx, 1.0 / camera.fy) {
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = camera.Unproject({u, v}, 1.0);
      rays_x_.at<float>(v, u) = static_cast<float>(ray.x());
      rays_y_.at<float>(v, u) = static_cast<float>(ray.y());
    }
  }
  tiles_ = MakeTiles(kTileSize);
  band_tiles_ = MakeTiles(kBandRows);
}

std::vector<Renderer::Tile> Renderer::MakeTiles(int rows) const {
  const cv::Rect image(0, 0, rays_x_.cols, rays_x_.rows);
  std::vector<Tile> tiles;
  for (int v = 0; v < image.height; v += rows) {
    for (int u = 0; u < image.width; u += kTileSize) {
      const cv::Rect pixels = cv::Rect(u, v, kTileSize, rows) & image;
      Eigen::Vector2d low, high;
      cv::minMaxLoc(rays_x_(pixels), &low.x(), &high.x());
      cv::minMaxLoc(rays_y_(pixels), &low.y(), &high.y());
      tiles.push_back({pixels, {low.cast<float>(), high.cast<float>()}});
    }
  }
  return tiles;
}

void Renderer::RenderTile(const std::vector<VisibleFace>& faces,
                          const Tile& tile, Rendering* out) const {
  const NearestFaces nearest = FindNearest(
      faces, tile.range, rays_x_(tile.pixels), rays_y_(tile.pixels));
  for (int row = 0; row < tile.pixels.height; ++row) {
    const int* index = nearest.index.data() + row * kTileSize;
    const float* inverse_depth = nearest.inverse_depth.data() + row * kTileSize;
    const cv::Point start = tile.pixels.tl() + cv::Point(0, row);
    float* depth = &out->depth.at<float>(start);
    cv::Vec3b* color = &out->color.at<cv::Vec3b>(start);
    // Neighbours on the same face are painted together.
    for (int first = 0, end = 0; first < tile.pixels.width; first = end) {
      while (end < tile.pixels.width && index[end] == index[first]) ++end;
      if (index[first] < 0) continue;
      for (int k = first; k < end; ++k) depth[k] = 1.0f / inverse_depth[k];
      const VisibleFace& visible = faces[index[first]];
      const float gloss = 255.0f * visible.face->material.gloss;
      SurfacePoints points;
      points.size = end - first;
      Meet(visible.face_from_ray, &rays_x_.at<float>(start) + first,
           &rays_y_.at<float>(start) + first, depth + first, pixel_, &points);
      Paint(visible.face->material, visible.face->seed, &points);
      for (int k = 0; k < points.size; ++k) {
        const Vector3f point(points.u[k], points.v[k], 0.0f);
        const Vector3f lamp = visible.lamp - point;
        float shine = 0.0f;
        if (gloss > 0.0f) shine = Highlight(lamp, visible.camera - point);
        color[first + k] = points.colors[k] * (255.0f * Brightness(lamp)) +
                           cv::Vec3f::all(gloss * shine);
      }
    }
  }
}

Rendering Renderer::Render(
    const std::function<Rigid3d(double t)>& world_from_cam, double t,
    double readout_s) const {
  const int height = rays_x_.rows;
  const bool has_bands = readout_s != 0.0;
  const std::vector<Tile>& tiles = has_bands ? band_tiles_ : tiles_;
  const int band_rows = has_bands ? kBandRows : height;
  const Shutter shutter = {0.0, readout_s};
  std::vector<std::vector<VisibleFace>> faces;  // by band
  for (int first = 0; first < height; first += band_rows) {
    const double middle =
        (first + std::min(first + band_rows, height) - 1) / 2.0;
    const double time = t + shutter.RowTime(middle, height);
    const Rigid3d pose = world_from_cam(time);
    AddVisibleFaces(scene_, pose, &faces.emplace_back());
    for (const SyntheticMover& mover : movers_) {
      AddVisibleFaces(mover.scene,
                      mover.world_from_mover(time).Inverse() * pose,
                      &faces.back());
    }
  }
  Rendering out;
  out.color = cv::Mat::zeros(rays_x_.size(), CV_8UC3);
  out.depth = cv::Mat::zeros(rays_x_.size(), CV_32FC1);
  cv::parallel_for_(cv::Range(0, static_cast<int>(tiles.size())),
                    [&](const cv::Range& range) {
                      for (int i = range.start; i < range.end; ++i) {
                        RenderTile(faces[tiles[i].pixels.y / band_rows],
                                   tiles[i], &out);
                      }
                    });
  cv::GaussianBlur(out.color, out.color, cv::Size(3, 3), kLensBlur);
  return out;
}

}  // namespace rgbd_pose
