#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A point of a map with its colour.
struct ColoredPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  // m
  std::array<uint8_t, 3> color = {};                   // red, green, blue
};

// A coloured surface.
struct TriangleMesh {
  std::vector<ColoredPoint> vertices;  // of the triangles

  // Indices into `vertices`, counter-clockwise as seen from the camera.
  std::vector<Eigen::Vector3i> triangles;
};

// Writes a mesh completely or not at all, in the format given by the extension,
// .ply or .glb. Throws InputError on failure and for another extension.
// For .glb, see FormatGlb; .ply has the axes of the world.
void WriteMesh(const std::string& path, const TriangleMesh& mesh,
               const Rigid3d& level_from_world = Rigid3d());

// Throws InputError if WriteMesh would; to be called before long computations.
void RequireMeshFile(const std::string& path);

// The same for WritePly.
void RequireCloudFile(const std::string& path);

// A mesh as a binary glTF 2.0 file (.glb) with unlit colours, as images contain
// the light already. In glTF y points up and z towards the viewer.
// `level_from_world` turns the world so that y points down and z ahead, as of a
// level camera; the result is rotated around x.
std::string FormatGlb(const TriangleMesh& mesh,
                      const Rigid3d& level_from_world = Rigid3d());

// A mesh as a PLY file: binary little-endian, per vertex x y z (float, metres)
// and red green blue (uchar), per face three vertex_indices (int). (G. Turk,
// The PLY Polygon File Format, 1994.)
std::string FormatMeshPly(const TriangleMesh& mesh);

// Writes a PLY file without faces like WriteMesh, whatever its extension.
void WritePly(const std::string& path, const std::vector<ColoredPoint>& points);

}  // namespace rgbd_pose
