// What modules and nodes that are written in Python have in common: two halves, parameters and state.
//
// The one half is held by a pipeline or a scene, and calls methods of the other, the Python object, which it
// holds. What these raise leaves the step as it is, with its traceback.
#pragma once

#include <nanobind/nanobind.h>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framework/graph/configurable.h"
#include "framework/graph/node.h"
#include "framework/graph/state.h"
#include "python/src/python_scene.h"

namespace weir::python {

namespace nb = nanobind;

class PartBase;

/// What the infos of types refer to.
struct PartTexts {
  std::string type, doc;
};

/// The docstring of a class without its indentation; "" if it has none.
std::string docOf(nb::handle type);

/// What is said of a parameter where it is declared, see weir.Param.
struct PythonParameter {
  std::string name, unit, doc;
  double min, max;
  bool aboveMin, live, animated;
};

class PythonPart {
 public:
  virtual ~PythonPart();
  PythonPart(const PythonPart&) = delete;
  PythonPart& operator=(const PythonPart&) = delete;

  /// The kind of the parameter is that of its first value: bool, int, float, str, or a sequence of two or
  /// three numbers. Throws Python's TypeError for others.
  void define(const PythonParameter& parameter, nb::handle initial);
  /// The value of a parameter at the present time.
  nb::object get(const std::string& name) const;
  /// Also once it is in a scene.
  void assign(const Value& values);

  /// Holds the Python object from now on, as a pipeline or a scene holds this.
  void keep(nb::object self) { self_ = std::move(self); }
  nb::object self() const { return self_; }
  PythonScene* scene() const { return scene_; }
  virtual const std::string& name() const = 0;
  /// Whose parameters it has in the scene.
  virtual Target target() const = 0;

 protected:
  /// `owner` is the node or module that this is a part of.
  PythonPart(Configurable& owner, PartBase& half, PartTexts texts);

  const PartTexts& texts() const { return texts_; }
  void attach(PythonScene& scene) { scene_ = &scene; }
  /// Calls a method; what it raises gets a note that names the node. Needs the GIL.
  template <class... Arguments>
  nb::object call(const char* method, Arguments&&... arguments) const {
    return self_.attr("_call")(method, std::forward<Arguments>(arguments)...);
  }
  /// Adds what the method report() returns.
  void addReport(NodeReport& report) const;
  /// What the class names in `state`, and what its method save() returns; see weir.Module.
  void saveTo(const StateWriter& to) const;
  void restoreFrom(const StateReader& from);

 private:
  template <class T>
  void addParam(const std::string& name, nb::handle initial, ParamSpec spec);

  Configurable& owner_;
  PartBase& half_;
  PartTexts texts_;
  std::deque<std::string> strings_;  // that parameters refer to
  std::vector<std::unique_ptr<Property>> parameters_;
  std::map<std::string, std::function<Value()>> getters_;
  nb::object self_;
  PythonScene* scene_ = nullptr;  // outlives this
};

/// The half that Python sees: the base of weir.Module and weir.Node. It owns the other half until a pipeline
/// or a scene does.
class PartBase {
 public:
  /// Throws a usage Error if there is none: before `begin`, and when what held it is gone.
  PythonPart& part() const;
  /// Makes the other half, a PythonModule or a PythonNode.
  template <class Part>
  void begin(PartTexts texts) {
    if (part_ != nullptr) throw usageError("it is made already", "one call of __init__");
    own_ = std::make_unique<Part>(*this, std::move(texts));
    part_ = own_.get();
  }
  /// Gives it to a pipeline (a Module) or a scene (a Node). Throws a usage Error if it is in one already.
  template <class T>
  std::unique_ptr<T> give(nb::object self) {
    checkFree();
    T* const given = dynamic_cast<T*>(own_.get());
    WEIR_CHECK(given != nullptr);
    own_->keep(std::move(self));
    static_cast<void>(own_.release());
    return std::unique_ptr<T>(given);
  }

 private:
  friend class PythonPart;
  void checkFree() const;

  std::unique_ptr<PythonPart> own_;
  PythonPart* part_ = nullptr;
};

/// Calls the class, and gives what it makes away.
template <class T>
std::unique_ptr<T> makePythonPart(nb::handle type) {
  const nb::gil_scoped_acquire gil;
  nb::object made = type();
  PartBase& half = nb::cast<PartBase&>(made);
  return half.give<T>(std::move(made));
}

void bindPart(nb::module_& m);

}  // namespace weir::python
