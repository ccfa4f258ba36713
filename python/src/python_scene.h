// A scene as Python holds it: first alone, then in a simulation, later perhaps in another one.
//
// Everything that Python has of a scene (nodes, modules, simulations, particles) shares one PythonScene and
// finds things in it by name, so no handle can outlive what it stands for. All members are used with the GIL
// held; while a thread steps without it, others are refused.
#pragma once

#include <nanobind/nanobind.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "framework/base/log.h"
#include "framework/particles/particle_set.h"
#include "framework/run/simulation.h"
#include "framework/scene/scene.h"
#include "python/src/library.h"

namespace weir::python {

namespace nb = nanobind;

/// Whose parameters are meant.
struct Target {
  enum class Kind { kWorld, kSection, kNode, kModule };
  Kind kind = Kind::kWorld;
  std::string name;    ///< of the section or node
  std::string module;  ///< of the node
};

class PythonScene : public std::enable_shared_from_this<PythonScene> {
 public:
  /// `folder` is what relative paths in the scene are relative to; "" if there are none.
  PythonScene(std::shared_ptr<Library> library, std::unique_ptr<Scene> scene, const std::string& folder);
  ~PythonScene();
  PythonScene(const PythonScene&) = delete;
  PythonScene& operator=(const PythonScene&) = delete;

  /// Throws a usage Error if another thread is stepping, as everything here is then in motion.
  Scene& scene() const;
  Node& node(const std::string& name) const;
  Module& module(const std::string& node, const std::string& name) const;
  PipelineBase& pipeline(const std::string& node) const;
  /// The particles of the fluid that a node puts out. Throws a usage Error if it has none.
  ParticleSet& particles(const std::string& node) const;

  void addNode(std::unique_ptr<Node> node, const std::string& name, const Value& parameters);
  void give(const std::string& node, nb::dict arrays);
  void link(const std::string& text);
  Value get(const Target& target, const std::vector<std::string>& path) const;
  void assign(const Target& target, const Value& values);
  /// Inserts at an index, or takes the place of the one of that name if `index` is empty.
  void insertModule(const std::string& node, std::unique_ptr<Module> module, const std::string& name,
                    std::optional<std::size_t> index);
  /// Reads what a module is to be like as a scene would (framework/scene/moved_modules.h): its type, empty
  /// where none is named, and its parameters may become others. Returns whether they did.
  bool readMoved(const std::string& node, const std::string& name, std::string& type, Value& params);

  /// As a scene file in `folder` has it: relative paths become absolute if that is another one than they came
  /// from. With "" they stay as they are. `files` are those that will hold the arrays that nodes were given,
  /// by the nodes' names. Throws a usage Error for arrays without a file.
  std::string toJson(const std::string& folder, const std::map<std::string, std::string>& files) const;

  /// Takes the scene into a simulation; the one before ends. Its number tells who owns it. The device is
  /// opened as by openDevice. Nodes keep memory of it, so a scene has one device for good: asked for another
  /// one, this throws a usage Error.
  std::uint64_t simulate(const std::string& device, int threads);
  /// Takes it out again.
  void endSimulation();
  Simulation* simulation() const { return simulation_.get(); }
  std::uint64_t simulationNumber() const { return number_; }
  /// Null before the first simulation.
  const std::shared_ptr<Device>& device() const { return device_; }

  /// What changed since the last reset and takes a reset to take effect; "" for nothing.
  std::string staleBecause;

  const std::shared_ptr<const Registry>& registry();
  Library& library() const { return *library_; }
  Log& log() { return log_; }

  /// While it lives, this thread alone may use the scene.
  class Stepping {
   public:
    explicit Stepping(PythonScene& scene);
    ~Stepping() { scene_.stepping_.reset(); }
    Stepping(const Stepping&) = delete;
    Stepping& operator=(const Stepping&) = delete;

   private:
    PythonScene& scene_;
  };
  bool isStepping() const { return stepping_.has_value(); }

  /// A module of a fluid in Python whose method is called.
  struct Running {
    std::string node;
    bool knowsNeighbors = false;  ///< whether the neighbours of this step have been found
  };
  std::optional<Running> running;

 private:
  void checkFree() const;
  /// The scene as a file has it, without what nodes were given.
  Value written(const std::string& folder) const;
  Configurable& find(const Target& target) const;
  void attachParts();
  void openDeviceOnce(const std::string& device, int threads);
  /// Whether the module's type no longer has what is assigned, which then is done as a scene is read.
  bool assignMoved(const Target& target, const Value& values);
  void noteChange(const Configurable& of, const Target& target, const Value& values);

  std::shared_ptr<Library> library_;
  std::filesystem::path folder_;                             // absolute; "" if no path is relative
  std::vector<std::shared_ptr<const Registry>> registries_;  // all that made something here
  Log log_;
  std::shared_ptr<Device> device_;
  std::string deviceAskedFor_;
  int threadsAskedFor_ = 0;
  std::unique_ptr<Scene> scene_;  // while there is no simulation
  std::unique_ptr<Simulation> simulation_;
  std::uint64_t number_ = 0;
  std::optional<std::thread::id> stepping_;
};

void bindScene(nb::module_& m);

}  // namespace weir::python
