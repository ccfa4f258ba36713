#include "python/src/values.h"

#include <nanobind/stl/string.h>

#include <filesystem>
#include <string>

#include "framework/scene/scene_file.h"

namespace weir::python {

namespace {

Value converted(nb::handle object, const std::shared_ptr<const ValueOrigin>& origin, int depth);

Value textOf(nb::handle text, const std::shared_ptr<const ValueOrigin>& origin) {
  Value value(nb::cast<std::string>(text));
  value.origin = origin;
  return value;
}

Value integerOf(nb::handle object) {
  const std::int64_t number = PyLong_AsLongLong(object.ptr());
  if (number == -1 && PyErr_Occurred() != nullptr) throw nb::python_error();
  return number;
}

Value mappingOf(nb::handle object, const std::shared_ptr<const ValueOrigin>& origin, int depth) {
  Value value = Value::object();
  for (const auto item : nb::steal(PyMapping_Items(object.ptr()))) {
    if (!nb::isinstance<nb::str>(item[0])) throw nb::type_error("names of parameters are strings");
    value[nb::cast<std::string>(nb::object(item[0]))] = converted(nb::object(item[1]), origin, depth);
  }
  return value;
}

Value converted(nb::handle object, const std::shared_ptr<const ValueOrigin>& origin, int depth) {
  if (depth > kDeepestNesting) throw nb::value_error("the value is nested too deeply");
  if (object.is_none()) return {};
  if (PyBool_Check(object.ptr())) return object.ptr() == Py_True;
  if (PyLong_Check(object.ptr())) return integerOf(object);
  if (PyFloat_Check(object.ptr())) return nb::cast<double>(object);
  if (nb::isinstance<nb::str>(object)) return textOf(object, origin);
  // NumPy's scalars and arrays, and those of other libraries, give Python's own types.
  if (nb::hasattr(object, "tolist")) return converted(object.attr("tolist")(), origin, depth + 1);
  if (nb::hasattr(object, "__fspath__")) return textOf(object.attr("__fspath__")(), origin);
  if (PyIndex_Check(object.ptr()) != 0) return integerOf(nb::steal(PyNumber_Index(object.ptr())));
  if (PyDict_Check(object.ptr()) || nb::hasattr(object, "keys")) return mappingOf(object, origin, depth + 1);
  if (PySequence_Check(object.ptr()) != 0 && !PyBytes_Check(object.ptr())) {
    Value value = Value::array();
    for (const nb::handle item : object) value.push(converted(item, origin, depth + 1));
    return value;
  }
  if (nb::hasattr(object, "__float__")) return nb::cast<double>(object.attr("__float__")());
  const std::string type = nb::cast<std::string>(object.type().attr("__name__"));
  throw nb::type_error(("a parameter cannot be given as a " + type).c_str());
}

}  // namespace

Value toValue(nb::handle object) {
  const ValueOrigin here{"", std::filesystem::current_path().string()};
  return converted(object, std::make_shared<const ValueOrigin>(here), 0);
}

nb::object toPython(const Value& value, bool frozen) {
  if (value.isNull()) return nb::none();
  if (value.isBool()) return nb::bool_(value.asBool());
  if (value.isInt()) return nb::int_(value.asInt());
  if (value.isNumber()) return nb::float_(value.asDouble());
  if (value.isString()) return nb::str(value.asString().c_str(), value.asString().size());
  if (value.isArray()) {
    nb::list list;
    for (const Value& item : value.asArray()) list.append(toPython(item, frozen));
    if (frozen) return nb::tuple(list);
    return list;
  }
  nb::dict dict;
  for (const auto& [key, member] : value.asObject()) dict[key.c_str()] = toPython(member, frozen);
  return dict;
}

}  // namespace weir::python
