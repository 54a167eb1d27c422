#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "frontend/settings/settings.h"

// Keyword arguments from a table of settings. The functions take py::kwargs and
// define their own signatures, because pybind11 only knows fixed arguments.

namespace rgbd_pose {

// Sets the settings given as keywords. Raises TypeError for an unknown keyword
// or a value of another type, and InputError for unknown names.
void SetFromKeywords(const std::string& function,
                     const pybind11::dict& keywords,
                     const std::vector<Setting>& table);

// The rows as the arguments of a signature: "cost: str = 'epipolar', ...".
std::string ArgumentsOf(const std::vector<Setting>& table);

// The rows as help text, one paragraph each.
std::string HelpOf(const std::vector<Setting>& table);

// Defines a function whose last argument is py::kwargs. In its signature and
// help, the rows of the table replace this argument.
template <typename Function, typename... Extra>
void DefineWithSettings(pybind11::module_* module, const char* name,
                        const Function& function,
                        const std::vector<Setting>& table, const char* help,
                        const Extra&... extra) {
  const pybind11::cpp_function probe(function, pybind11::name(name), extra...);
  auto signature = probe.attr("__doc__").template cast<std::string>();
  const std::string keywords = "**kwargs";
  // py::kw_only() is only shown if named arguments follow it.
  const bool has_star = signature.find(" *, ") != std::string::npos;
  signature.replace(signature.find(keywords), keywords.size(),
                    (has_star ? "" : "*, ") + ArgumentsOf(table));
  const std::string text = signature + help + "\n\n" + HelpOf(table);
  pybind11::options options;
  options.disable_function_signatures();
  module->def(name, function, text.c_str(), extra...);
}

}  // namespace rgbd_pose
