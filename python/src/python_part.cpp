#include "python/src/python_part.h"

#include <nanobind/stl/string.h>

#include "framework/graph/param_types.h"
#include "python/src/errors.h"
#include "python/src/python_module.h"
#include "python/src/python_node.h"
#include "python/src/values.h"

namespace weir::python {

namespace {

constexpr const char* kState = "python";

/// What a method report() has returned, as an object.
Value reportedNumbers(nb::handle said, const std::string& of) {
  std::string found = "found a " + nb::cast<std::string>(said.type().attr("__name__"));
  try {
    Value values = toValue(said);
    if (values.isObject()) return values;
  } catch (const nb::builtin_exception& e) {
    found = e.what();
  }
  throw nb::type_error(("report() of '" + of + "' returns no dict of numbers: " + found).c_str());
}

Module& moduleOf(const PartBase& half) {
  return dynamic_cast<Module&>(half.part());
}

}  // namespace

std::string docOf(nb::handle type) {
  const nb::object doc = type.attr("__doc__");
  if (doc.is_none()) return {};
  return nb::cast<std::string>(nb::module_::import_("inspect").attr("cleandoc")(doc));
}

PythonPart::PythonPart(Configurable& owner, PartBase& half, PartTexts texts)
    : owner_(owner), half_(half), texts_(std::move(texts)) {}

PythonPart::~PythonPart() {
  const nb::gil_scoped_acquire gil;
  half_.part_ = nullptr;
  self_.reset();  // the other half may go with it
}

template <class T>
void PythonPart::addParam(const std::string& name, nb::handle initial, ParamSpec spec) {
  const T value = ParamTraits<T>::fromValue(toValue(initial), spec, {});
  auto param = std::make_unique<Param<T>>(owner_, name, value, spec);
  getters_[name] = [p = param.get()] { return ParamTraits<T>::toValue(p->get()); };
  parameters_.push_back(std::move(param));
}

void PythonPart::define(const PythonParameter& p, nb::handle initial) {
  const auto keep = [&](const std::string& text) -> std::string_view { return strings_.emplace_back(text); };
  const ParamSpec spec{.unit = keep(p.unit),
                       .min = p.min,
                       .max = p.max,
                       .aboveMin = p.aboveMin,
                       .live = p.live,
                       .animated = p.animated,
                       .doc = keep(p.doc)};
  const Value value = toValue(initial);
  ParamSpec plain = spec;
  plain.animated = false;
  try {
    if (value.isBool()) return addParam<bool>(p.name, initial, plain);
    if (value.isInt()) return addParam<std::int64_t>(p.name, initial, plain);
    if (value.isNumber()) return addParam<double>(p.name, initial, spec);
    if (value.isString()) return addParam<std::string>(p.name, initial, plain);
    if (value.isArray() && value.asArray().size() == 2) return addParam<Vec2f>(p.name, initial, plain);
    if (value.isArray() && value.asArray().size() == 3) return addParam<Vec3f>(p.name, initial, spec);
  } catch (Error& e) {
    throw e.inParameter(p.name);
  }
  throw nb::type_error(
      ("the parameter '" + p.name + "' begins as none of bool, int, float, str, or two or three numbers")
          .c_str());
}

nb::object PythonPart::get(const std::string& name) const {
  const auto getter = getters_.find(name);
  if (getter == getters_.end()) throw nb::attribute_error(name.c_str());
  return toPython(getter->second(), true);
}

void PythonPart::assign(const Value& values) {
  if (scene_ == nullptr) return owner_.assignAll(values, {});
  scene_->assign(target(), values);
}

void PythonPart::addReport(NodeReport& report) const {
  const nb::gil_scoped_acquire gil;
  const nb::object said = call("report");
  if (said.is_none()) return;
  const Value numbers = reportedNumbers(said, name());
  for (const auto& [key, value] : numbers.asObject()) report.statistics[key] = value;
}

void PythonPart::saveTo(const StateWriter& to) const {
  const nb::gil_scoped_acquire gil;
  const nb::bytes state = nb::cast<nb::bytes>(call("_saved_state"));
  to.put(kState, std::span<const char>(state.c_str(), state.size()));
}

void PythonPart::restoreFrom(const StateReader& from) {
  const std::vector<char> state = from.getAll<char>(kState);
  const nb::gil_scoped_acquire gil;
  call("_restore_state", nb::bytes(state.data(), state.size()));
}

PythonPart& PartBase::part() const {
  if (part_ == nullptr)
    throw usageError("the module or node has no parameters",
                     "one that called super().__init__(), and whose scene is still there");
  return *part_;
}

void PartBase::checkFree() const {
  static_cast<void>(part());
  if (!own_) throw usageError("the module or node is in a scene already", "another object for another place");
}

void bindPart(nb::module_& m) {
  nb::class_<PartBase>(m, "PartBase", "What weir.Module and weir.Node are made of.", nb::dynamic_attr())
      .def(nb::init<>())
      .def(
          "_begin_module",
          [](PartBase& b, std::string type, std::string doc) {
            b.begin<PythonModule>({std::move(type), std::move(doc)});
          },
          nb::arg("type"), nb::arg("doc"))
      .def(
          "_begin_node",
          [](PartBase& b, std::string type, std::string doc) {
            b.begin<PythonNode>({std::move(type), std::move(doc)});
          },
          nb::arg("type"), nb::arg("doc"))
      .def(
          "_define",
          [](PartBase& b, std::string name, nb::handle initial, std::string unit, std::string doc, double min,
             double max, bool above, bool live, bool animated) {
            b.part().define(
                {std::move(name), std::move(unit), std::move(doc), min, max, above, live, animated}, initial);
          },
          nb::arg("name"), nb::arg("initial"), nb::arg("unit"), nb::arg("doc"), nb::arg("min"),
          nb::arg("max"), nb::arg("above"), nb::arg("live"), nb::arg("animated"))
      .def(
          "_get", [](const PartBase& b, const std::string& name) { return b.part().get(name); },
          nb::arg("name"))
      .def(
          "_assign", [](const PartBase& b, nb::handle values) { b.part().assign(toValue(values)); },
          nb::arg("values"))
      .def_prop_rw(
          "_enabled", [](const PartBase& b) { return moduleOf(b).enabled(); },
          [](PartBase& b, bool on) { moduleOf(b).enable(on); })
      .def_prop_ro(
          "name", [](const PartBase& b) { return b.part().name(); },
          "Its name in the pipeline or the scene; \"\" outside.");
}

}  // namespace weir::python
