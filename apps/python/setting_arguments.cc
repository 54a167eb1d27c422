#include "apps/python/setting_arguments.h"

#include "core/util/named_values.h"
#include "core/util/text_file.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// The current value of a row.
py::object CurrentOf(const Setting& setting) {
  return std::visit(
      [](const auto& value) -> py::object {
        if constexpr (std::is_pointer_v<std::decay_t<decltype(value)>>) {
          return py::cast(*value);
        } else {
          return py::str(value.get());
        }
      },
      setting.value);
}

// The Python type name of a row.
std::string TypeOf(const Setting& setting) {
  return py::str(py::type::of(CurrentOf(setting)).attr("__name__"));
}

void Set(const Setting& setting, const py::handle& value) {
  std::visit(
      [&value](const auto& to) {
        if constexpr (std::is_pointer_v<std::decay_t<decltype(to)>>) {
          *to = value.cast<std::decay_t<decltype(*to)>>();
        } else {
          to.set(value.cast<std::string>());
        }
      },
      setting.value);
}

}  // namespace

void SetFromKeywords(const std::string& function, const py::dict& keywords,
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
                           TypeOf(*row));
    }
  }
}

std::string ArgumentsOf(const std::vector<Setting>& table) {
  std::string text;
  for (const Setting& setting : table) {
    if (!text.empty()) text += ", ";
    text += std::string(setting.name) + ": " + TypeOf(setting) + " = " +
            py::repr(CurrentOf(setting)).cast<std::string>();
  }
  return text;
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
