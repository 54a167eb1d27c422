// Exports a COLMAP model as text (colmap.github.io/format.html) with images, in
// the layout that COLMAP and compatible tools expect: images/, sparse/0/.

#include "apps/export/export_format.h"
#include "core/util/format.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

std::string FormatCamera(const Camera& camera) {
  std::vector<double> distortion = camera.Distortion();
  const bool is_fisheye = camera.lens_model == LensModel::kEquidistant;
  const bool is_full = distortion.size() == 8 || camera.k3 != 0.0;
  const char* model = !camera.HasDistortion() ? "PINHOLE"
                      : is_fisheye            ? "OPENCV_FISHEYE"
                      : is_full               ? "FULL_OPENCV"
                                              : "OPENCV";
  std::string text = Format("1 %s %d %d %.12g %.12g %.12g %.12g", model,
                            camera.width, camera.height, camera.fx, camera.fy,
                            camera.cx + kPixelCentre, camera.cy + kPixelCentre);
  if (camera.HasDistortion()) {
    distortion.resize(!is_fisheye && is_full ? 8 : 4);
    for (const double k : distortion) text += Format(" %.12g", k);
  }
  return "# camera, model, width, height, parameters\n" + text + "\n";
}

// cam_from_world with w first. The second line of an image (features) is empty.
std::string FormatImages(const FinishedRun& run,
                         const std::vector<int>& views) {
  std::string text = "# image, qw qx qy qz tx ty tz, camera, name; features\n";
  int number = 0;
  for (const int view : views) {
    const Rigid3d cam_from_world =
        run.trajectory[view].world_from_cam.Inverse();
    const Eigen::Quaterniond& q = cam_from_world.rotation;
    const Eigen::Vector3d& t = cam_from_world.translation;
    text += Format("%d %.12g %.12g %.12g %.12g %.12g %.12g %.12g 1 %s\n\n",
                   ++number, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z(),
                   ImageName(run, view).c_str());
  }
  return text;
}

// The points are from depth, not from features, so their errors are unknown and
// they have no tracks.
std::string FormatPoints(const std::vector<ColoredPoint>& points) {
  std::string text = "# point, x y z, red green blue, error, track\n";
  int number = 0;
  for (const ColoredPoint& p : points) {
    text += Format("%d %.6g %.6g %.6g %d %d %d 0\n", ++number, p.position.x(),
                   p.position.y(), p.position.z(), p.color[0], p.color[1],
                   p.color[2]);
  }
  return text;
}

// Writes the same points as points3D.bin, because some tools read long texts
// slowly.
std::string PackPoints(const std::vector<ColoredPoint>& points) {
  std::string bytes;
  AppendLittleEndian(uint64_t{points.size()}, &bytes);
  uint64_t number = 0;
  for (const ColoredPoint& p : points) {
    AppendLittleEndian(++number, &bytes);
    for (const float x : p.position) AppendLittleEndian(double{x}, &bytes);
    bytes.append(p.color.begin(), p.color.end());
    AppendLittleEndian(0.0, &bytes);          // error
    AppendLittleEndian(uint64_t{0}, &bytes);  // track length
  }
  return bytes;
}

}  // namespace

std::string ExportColmap(const FinishedRun& run, const ExportOptions& options) {
  OutputFolder folder(options.output, options.overwrite);
  const ExportedViews images =
      WriteViewImages(run, options, folder.MakeFolder("images"));
  const std::filesystem::path model = folder.MakeFolder("sparse/0");
  WriteFileAtomically(model / "cameras.txt", FormatCamera(images.camera));
  WriteFileAtomically(model / "images.txt", FormatImages(run, images.views));
  WriteFileAtomically(model / "points3D.txt", FormatPoints(images.cloud));
  WriteFileAtomically(model / "points3D.bin", PackPoints(images.cloud));
  folder.Publish();
  return Format("%zu images, %zu points in %s\n", images.views.size(),
                images.cloud.size(), options.output.c_str());
}

}  // namespace rgbd_pose
