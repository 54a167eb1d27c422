#include "core/geometry/camera.h"

#include <algorithm>
#include <cmath>

#include "core/util/format.h"

namespace rgbd_pose {
namespace {

using Eigen::Vector2d;

constexpr int kMaxIterations = 100;
constexpr double kTolerance = 1e-13;  // well below 1e-10 px for f < 1000
// Pixels with a larger remaining error have no undistorted position.
constexpr double kLargestError = 1e-8;

// Applies the distortion to a point on the plane z = 1.
Vector2d Distort(const Lens<double>& lens, const Vector2d& point) {
  Vector2d distorted;
  lens.Distort(point.x(), point.y(), &distorted.x(), &distorted.y());
  return distorted;
}

// The inverse of Distort by Newton's method from a first guess, in three or
// four steps. Returns false if it does not converge, or to where the lens has
// folded the image over.
bool InvertByNewton(const Lens<double>& lens, const Vector2d& distorted,
                    Vector2d* point) {
  constexpr int kMaxSteps = 10;
  constexpr double kLongestStep = 0.3;  // longer ones may jump across a fold
  for (int i = 0; i < kMaxSteps; ++i) {
    DistortedPoint<double> at;
    lens.Distort(point->x(), point->y(), &at);
    const double x = distorted.x() - at.x, y = distorted.y() - at.y;
    const double determinant = at.x_x * at.y_y - at.x_y * at.x_y;
    const Vector2d step((at.y_y * x - at.x_y * y) / determinant,
                        (at.x_x * y - at.x_y * x) / determinant);
    *point += step;
    const double change = step.lpNorm<Eigen::Infinity>();
    if (change <= kTolerance) return determinant > 0.0;
    if (!(change < kLongestStep)) return false;
  }
  return false;
}

// The inverse of Distort; NaN if there is none. Beyond a fold of the lens other
// points have the same image: where Newton's method may have jumped there, the
// inverse is followed from the middle of the image outwards.
Vector2d InvertRational(const Lens<double>& lens, const Vector2d& distorted) {
  Vector2d point = distorted;
  if (InvertByNewton(lens, distorted, &point)) return point;
  constexpr int kSteps = 20;
  point.setZero();
  for (int i = 1; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    if (!InvertByNewton(lens, share * distorted, &point)) {
      return Vector2d::Constant(std::nan(""));
    }
  }
  return point;
}

// The same for an equidistant lens: Newton's method for the angle.
Vector2d InvertEquidistant(const Lens<double>& lens,
                           const Vector2d& distorted) {
  const double wanted = distorted.norm();
  if (wanted < kTolerance) return distorted;
  double t = wanted;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double t2 = t * t;
    const double found =
        t *
        (1.0 + t2 * (lens.k1 + t2 * (lens.k2 + t2 * (lens.k3 + t2 * lens.k4))));
    const double slope =
        1.0 +
        t2 * (3.0 * lens.k1 +
              t2 * (5.0 * lens.k2 + t2 * (7.0 * lens.k3 + t2 * 9.0 * lens.k4)));
    const double change = (wanted - found) / slope;
    t += change;
    if (!(std::abs(change) > kTolerance)) break;
  }
  // tan would map angles beyond 90 degrees to valid positions.
  if (!(t > 0.0 && t < 0.5 * M_PI)) t = std::nan("");
  return distorted * (std::tan(t) / wanted);
}

// Exposure of rows of the first Kinect (Kerl et al., ICCV 2015), s.
constexpr double kKinectColorReadout = 0.028;
constexpr double kKinectDepthReadout = 0.027;

// TUM RGB-D benchmark, "intrinsic camera calibration" table; its depth factors
// are already applied in the released images. The lead of depth over
// colour (s) depends on the driver: 15 to 20 ms for freiburg1, 0 to 5 ms for
// freiburg3, unknown for freiburg2. The RGB-D Dynamic dataset of the University
// of Bonn has the sensor of freiburg3 (an Xtion), which is assumed to be read
// in the same way; its intrinsics are those of its page.
RgbdCamera TumCamera(const Camera& camera, double depth_lead) {
  constexpr Shutter kColor = {-0.0075, kKinectColorReadout, true};
  return {camera,
          5000.0,
          {},
          kColor,
          {kColor.offset - depth_lead, kKinectDepthReadout},
          *FindNamed(DepthNoiseModels(), "kinect")};
}

// Another Kinect: focal lengths that OpenNI's drivers state, exposure in the
// middle of the image at the stamp.
RgbdCamera KinectCamera(const Camera& camera) {
  return {camera,
          1000.0,
          {},
          {0.0, kKinectColorReadout, true},
          {0.0, kKinectDepthReadout},
          *FindNamed(DepthNoiseModels(), "kinect")};
}

const Named<RgbdCamera> kPresets[] = {
    {"tum_fr1",
     TumCamera({640, 480, 517.306408, 516.469215, 318.643040, 255.313989,
                0.262383, -0.953104, -0.005358, 0.002628, 1.163314},
               0.0175)},
    {"tum_fr2",
     TumCamera({640, 480, 520.908620, 521.007327, 325.141442, 249.701764,
                0.231222, -0.784899, -0.003257, -0.000105, 0.917205},
               0.0)},
    {"tum_fr3", TumCamera({640, 480, 535.4, 539.2, 320.1, 247.6}, 0.0025)},
    {"bonn",
     TumCamera({640, 480, 542.822841, 542.576870, 315.593520, 237.756098,
                0.039903, -0.099343, -0.000730, -0.000144, 0.0},
               0.0025)},
    {"kinect", KinectCamera({640, 480, 525.0, 525.0, 319.5, 239.5})},
    {"7scenes", KinectCamera({640, 480, 585.0, 585.0, 320.0, 240.0})},
    {"ros_default", {}},  // the defaults
};

}  // namespace

std::string Camera::Check() const {
  if (width <= 0 || height <= 0) return "image size must be positive";
  for (const CameraParameter& parameter : kCameraParameters) {
    if (!std::isfinite(this->*parameter.value)) {
      return "intrinsics must be finite numbers";
    }
  }
  if (fx <= 0.0 || fy <= 0.0) {
    return "fx and fy must be positive";
  }
  const double size = std::max(width, height);
  for (const double f : {fx, fy}) {  // views of 157 and of 0.6 degrees
    if (f < 0.1 * size || f > 100.0 * size) {
      return "fx and fy must be in pixels: 0.1 to 100 times the image's size";
    }
  }
  if (lens_model == LensModel::kEquidistant &&
      (p1 != 0.0 || p2 != 0.0 || k5 != 0.0 || k6 != 0.0)) {
    return "an equidistant lens has k1 to k4 only";
  }
  if (cx < 0.0 || cy < 0.0 || cx >= width || cy >= height) {
    return "the principal point must lie inside the image";
  }
  return "";
}

std::string Camera::SanityWarning() const {
  const auto line = [](const std::string& what) {
    return "camera: " + what +
           ", which is unusual; check the order of the values and the image "
           "size";
  };
  if (std::abs(fx / fy - 1.0) > 0.05) {
    return line("fx " + ShortNumber(fx) + " and fy " + ShortNumber(fy) +
                " differ by more than 5 %");
  }
  if (std::abs(cx - 0.5 * (width - 1)) > 0.1 * width ||
      std::abs(cy - 0.5 * (height - 1)) > 0.1 * height) {
    return line("the principal point (" + ShortNumber(cx) + ", " +
                ShortNumber(cy) + ") is far from the middle of " +
                std::to_string(width) + " x " + std::to_string(height) +
                " pixels");
  }
  return "";
}

bool Camera::HasDistortion() const {
  return lens_model == LensModel::kEquidistant || k1 != 0.0 || k2 != 0.0 ||
         p1 != 0.0 || p2 != 0.0 || k3 != 0.0 || k4 != 0.0 || k5 != 0.0 ||
         k6 != 0.0;
}

std::vector<double> Camera::Distortion() const {
  if (lens_model == LensModel::kEquidistant) return {k1, k2, k3, k4};
  if (k4 == 0.0 && k5 == 0.0 && k6 == 0.0) return {k1, k2, p1, p2, k3};
  return {k1, k2, p1, p2, k3, k4, k5, k6};
}

bool Camera::SetDistortion(LensModel model,
                           const std::vector<double>& coefficients) {
  const bool is_equidistant = model == LensModel::kEquidistant;
  const size_t given = coefficients.size();
  const bool is_known =
      given == 4 ||
      (!is_equidistant &&
       (given == 5 ||
        (given >= 8 && std::all_of(coefficients.begin() + 8, coefficients.end(),
                                   [](double c) { return c == 0.0; }))));
  if (!is_known) return false;
  lens_model = model;
  std::vector<double> all = coefficients;  // k1 k2 p1 p2 k3 k4 k5 k6
  if (is_equidistant) all.insert(all.begin() + 2, 2, 0.0);
  all.resize(8);
  constexpr size_t kFirst = kCameraParameters.size() - 8;
  for (size_t i = 0; i < 8; ++i) {
    this->*kCameraParameters[kFirst + i].value = all[i];
  }
  return true;
}

Vector2d Camera::Project(const Eigen::Vector3d& point) const {
  Vector2d plane = point.head<2>() / point.z();
  if (HasDistortion()) plane = Distort(MakeLens(), plane);
  return {fx * plane.x() + cx, fy * plane.y() + cy};
}

Eigen::Matrix2d Camera::ProjectDerivative(const Vector2d& place) const {
  Eigen::Matrix2d derivative = Eigen::Matrix2d::Zero();
  derivative.diagonal() << fx, fy;
  if (!HasDistortion()) return derivative;
  DistortedPoint<double> p;
  MakeLens().Distort(place.x(), place.y(), &p);
  derivative << fx * p.x_x, fx * p.x_y, fy * p.x_y, fy * p.y_y;
  return derivative;
}

Vector2d Camera::Undistort(const Vector2d& pixel) const {
  if (!HasDistortion()) return pixel;
  const Lens<double> lens = MakeLens();
  const Vector2d distorted = Ray(pixel.x(), pixel.y()).head<2>();
  const Vector2d plane = lens_model == LensModel::kEquidistant
                             ? InvertEquidistant(lens, distorted)
                             : InvertRational(lens, distorted);
  const Vector2d error = Distort(lens, plane) - distorted;
  if (!(error.lpNorm<Eigen::Infinity>() < kLargestError)) {
    return Vector2d::Constant(std::nan(""));
  }
  return {fx * plane.x() + cx, fy * plane.y() + cy};
}

Eigen::Vector3d Camera::Unproject(const Vector2d& pixel, double depth) const {
  const Vector2d ideal = Undistort(pixel);
  return Ray(ideal.x(), ideal.y()) * depth;
}

std::optional<RgbdCamera> CameraPreset(std::string_view name) {
  if (const auto* preset = FindNamed(kPresets, name)) return preset->value;
  return std::nullopt;
}

std::vector<std::string> CameraPresetNames() { return NamesOf(kPresets); }

}  // namespace rgbd_pose
