#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A map of a YAML file, also of OpenCV's. Any error (a missing key, a word that
// is no finite number, ...) is an InputError that names file, line and key.
class YamlSection {
 public:
  // The top level of a file; empty if the top level is not a map.
  static YamlSection FromFile(const std::string& path);
  static YamlSection FromText(const std::string& text, const std::string& path);

  const YAML::Node& node() const { return node_; }

  // All keys, in their order.
  std::vector<std::string> Keys() const;
  bool Has(const std::string& key) const;
  bool HasKeyStartingWith(const std::string& start) const;

  // The map below a key.
  YamlSection Child(const std::string& key) const;

  double Number(const std::string& key) const;
  double NumberOr(const std::string& key, double fallback) const;

  // A list of numbers whose length is one of `lengths`.
  std::vector<double> Numbers(const std::string& key,
                              const std::vector<size_t>& lengths) const;

  // A 4 x 4 matrix, row by row: a list of 4 lists of numbers, or of 16 numbers,
  // or OpenCV's section with such a list as its `data`.
  std::vector<double> Matrix(const std::string& key) const;

  // A rigid motion as such a matrix.
  Rigid3d RigidMotion(const std::string& key) const;

  // A whole number of pixels (> 0): of a key, or a number read from there.
  int Pixels(const std::string& key) const;
  int Pixels(const std::string& key, double number) const;

  // The value of a key, one of `known`; the first of them if it is missing.
  std::string Word(const std::string& key,
                   const std::vector<std::string>& known) const;

  // Throws an error for an existing key: "<file>:<line>: <key> <message>".
  [[noreturn]] void Fail(const std::string& key,
                         const std::string& message) const;

 private:
  YamlSection(const std::string& path, const std::string& prefix,
              const YAML::Node& node)
      : path_(path), prefix_(prefix), node_(node) {}

  YAML::Node Find(const std::string& key) const;
  double ToNumber(const std::string& key, const YAML::Node& node) const;

  std::string path_;
  std::string prefix_;     // of keys in error messages
  const YAML::Node node_;  // const: a lookup must not add the key
};

}  // namespace rgbd_pose
