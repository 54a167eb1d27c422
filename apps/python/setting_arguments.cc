#include "apps/python/setting_arguments.h"

#include "core/util/named_values.h"
#include "core/util/text_file.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// How Python calls the type of a row and what it has now.
struct Argument {
  const char* type;
  py::object value;
};

Argument ArgumentOf(const Setting& setting) {
  if (int* const* whole = std::get_if<int*>(&setting.value)) {
    return {"int", py::int_(**whole)};
  }
  if (double* const* real = std::get_if<double*>(&setting.value)) {
    return {"float", py::float_(**real)};
  }
  if (bool* const* yes = std::get_if<bool*>(&setting.value)) {
    return {"bool", py::bool_(**yes)};
  }
  return {"str", py::str(std::get<NamedSetting>(setting.value).get())};
}

void Set(const Setting& setting, const py::handle& value) {
  if (int* const* whole = std::get_if<int*>(&setting.value)) {
    **whole = value.cast<int>();
  } else if (double* const* real = std::get_if<double*>(&setting.value)) {
    **real = value.cast<double>();
  } else if (bool* const* yes = std::get_if<bool*>(&setting.value)) {
    **yes = value.cast<bool>();
  } else {
    std::get<NamedSetting>(setting.value).set(value.cast<std::string>());
  }
}

}  // namespace

void SetFromKeywords(const std::string& function, const py::kwargs& keywords,
                     const std::vector<Setting>& table) {
  for (const auto& [key, value] : keywords) {
    const auto name = key.cast<std::string>();
    const Setting* const row = FindNamed(table, name);
    if (row == nullptr) {
      throw py::type_error(
          function + "() got an unexpected keyword argument '" + name + "'");
    }
    try {
      Set(*row, value);
    } catch (const py::cast_error&) {
      throw py::type_error(function + "(): " + name + " must be " +
                           ArgumentOf(*row).type);
    }
  }
}

std::string ArgumentsOf(const std::vector<Setting>& table) {
  std::string text;
  for (const Setting& setting : table) {
    const Argument argument = ArgumentOf(setting);
    if (!text.empty()) text += ", ";
    text += std::string(setting.name) + ": " + argument.type + " = " +
            py::repr(argument.value).cast<std::string>();
  }
  return text;
}

std::string InitSignature(const std::string& class_name,
                          const std::vector<Setting>& table) {
  return "__init__(self: rgbd_pose." + class_name +
         ", camera: rgbd_pose.Camera, " +
         ArgumentsOf({*FindNamed(table, "frontend")}) + ", *, " +
         ArgumentsOf(WithoutRow("frontend", table)) +
         ") -> None\n\nInputError for unknown names and values out of range.";
}

std::string HelpOf(const std::vector<Setting>& table) {
  std::string text;
  for (const Setting& setting : table) {
    text += std::string(setting.name) + ": " + setting.help;
    if (!setting.choices.empty()) {
      text += " (" + Join(setting.choices) + ")";
    }
    text += ".\n";
  }
  return text;
}

}  // namespace rgbd_pose
