#pragma once

#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/util/input_error.h"
#include "frontend/tracking/tracked_frame.h"

// Serialises objects for `pickle` and `copy`, between processes of the same
// version, not for storage. A class provides a function
//   void EachField(PickledBytes* bytes, Class& object)
// that calls (*bytes)(object.field, ...) with all relevant fields, for writing
// and for reading.

namespace rgbd_pose {

// Writes fields, or reads them in the same order.
class PickledBytes {
 public:
  PickledBytes() = default;  // for writing

  explicit PickledBytes(std::string bytes)
      : bytes_(std::move(bytes)), is_reading_(true) {}

  const std::string& bytes() const { return bytes_; }

  // Throws InputError if there are too few bytes.
  template <typename... Ts>
  void operator()(Ts&... fields) {
    (Field(fields), ...);
  }

 private:
  void Raw(void* data, size_t size) {
    if (size == 0) return;
    if (!is_reading_) {
      bytes_.append(static_cast<const char*>(data), size);
      return;
    }
    if (size > bytes_.size() - at_) throw InputError("pickle: is cut off");
    std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }

  template <typename List>
  void Resize(List* list) {
    uint64_t size = list->size();
    Field(size);
    if (!is_reading_) return;
    if (size > bytes_.size() - at_) throw InputError("pickle: is cut off");
    list->resize(size);
  }

  template <typename T>
  void Field(T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      Raw(&value, sizeof(value));
    } else {
      EachField(this, value);
    }
  }
  void Field(std::string& text) {
    Resize(&text);
    Raw(text.data(), text.size());
  }
  template <typename T>
  void Field(std::vector<T>& list) {
    Resize(&list);
    for (auto&& value : list) Field(value);
  }
  template <typename T>
  void Field(std::optional<T>& value) {
    bool is_there = value.has_value();
    Field(is_there);
    if (is_there && is_reading_) value.emplace();
    if (is_there) Field(*value);
  }
  template <int kRows, int kColumns>
  void Field(Eigen::Matrix<double, kRows, kColumns>& matrix) {
    Raw(matrix.data(), sizeof(double) * matrix.size());
  }
  void Field(Rigid3d& motion) {
    (*this)(motion.rotation.coeffs(), motion.translation);
  }
  void Field(cv::Mat& image) {
    int rows = image.rows, columns = image.cols, type = image.type();
    (*this)(rows, columns, type);
    if (is_reading_) image.create(rows, columns, type);
    const size_t row_bytes = image.elemSize() * image.cols;
    for (int y = 0; y < image.rows; ++y) Raw(image.ptr(y), row_bytes);
  }

  std::string bytes_;
  bool is_reading_ = false;
  size_t at_ = 0;
};

// The following types are members of several classes.

inline void EachField(PickledBytes* bytes, DepthNoiseModel& model) {
  (*bytes)(model.name, model.constant, model.quadratic, model.centre,
           model.mean_share);
}

inline void EachField(PickledBytes* bytes, RgbdCamera& c) {
  (*bytes)(c.camera, c.depth_scale, c.depth_correction.inverse_depth_offset,
           c.depth_correction.depth_from_color, c.color_shutter,
           c.depth_shutter, c.depth_noise);
}

inline void EachField(PickledBytes* bytes, RelativePose& pose) {
  (*bytes)(pose.ref, pose.cur, pose.cur_from_ref, pose.covariance);
}

inline void EachField(PickledBytes* bytes, TrackedFrame& f) {
  (*bytes)(f.index, f.timestamp, f.status, f.reason, f.world_from_cam,
           f.segment, f.reference, f.cur_from_reference, f.is_reference,
           f.relocalised, f.previous_is_reference, f.is_predicted, f.edges,
           f.source, f.matches, f.inliers, f.iterations, f.sigma, f.decode_ms,
           f.track_ms, f.match_ms, f.solve_ms, f.reference_ms, f.relocalise_ms);
}

// What makes a class picklable; an argument for py::class_<T>::def.
template <typename T>
auto Pickled() {
  namespace py = pybind11;
  return py::pickle(
      [](const T& self) {
        PickledBytes bytes;
        T copy = self;  // fields are not const
        bytes(copy);
        return py::make_tuple(RGBD_POSE_VERSION, py::bytes(bytes.bytes()));
      },
      [](const py::tuple& state) {
        if (state.size() != 2 ||
            state[0].cast<std::string>() != RGBD_POSE_VERSION) {
          throw InputError("pickle: is from another version of rgbd_pose");
        }
        PickledBytes bytes(state[1].cast<std::string>());
        T object;
        bytes(object);
        return object;
      });
}

}  // namespace rgbd_pose
