// The options of the command line by which plugins' outputs are asked for, such as --video and --export.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/weir/program.h"
#include "framework/base/output_lock.h"
#include "framework/communication/communicator.h"
#include "framework/run/output_kind.h"

namespace weir::app {

/// Adds --engine to a command that makes pictures; `engine` stays empty if it is not given.
void addEngineOption(CLI::App& command, std::string& engine);
/// The change of the scene that the option asks for, if it was given.
void addEngine(const std::string& engine, std::vector<Override>& changes);

/// Which file is written, or read, for which option: no two may be the same.
class TakenPaths {
 public:
  /// A file that is read: "the scene".
  void addInput(const std::string& path, const std::string& what);
  /// A file or folder that is written, or "" if the option was not given. Throws a usage Error if it does not
  /// end as it must, or is taken; an io Error if the folder above is missing.
  void addOutput(const OutputOption& option, const std::string& path);
  /// Keeps other runs from all outputs. Throws an io Error that says who has one.
  std::vector<OutputLock> lock() const;

 private:
  std::map<std::string, std::string> taken_;  // what for, by path
  std::vector<std::string> outputs_;
};

class OutputOptions {
 public:
  /// Adds the options of all kinds of outputs, or of those that show replays, to a command. Must stay where
  /// it is.
  OutputOptions(CLI::App& command, Program& program, bool replaysOnly);
  OutputOptions(const OutputOptions&) = delete;
  OutputOptions& operator=(const OutputOptions&) = delete;

  /// Whether any was given.
  bool any() const;
  /// Whether any was given that is not written by every rank, for a run of this scene on these.
  bool anyGathered(const Scene& scene, const Communicator& ranks) const;
  void checkPaths(TakenPaths& taken) const;
  /// Of all that were given; on ranks but the first one of those that every rank writes. Null: no ranks.
  std::vector<std::unique_ptr<Observer>> makeObservers(const Scene& scene, Communicator* ranks) const;
  /// Prints the paths that were given, a line each.
  void print() const;
  /// "--images, --video"
  std::string names() const;

 private:
  struct Output {
    std::string name, source;  // of the kind, and the library that brings it
    std::unique_ptr<OutputKind> kind;
    std::vector<OutputOption> options;
    std::vector<std::string> paths;  // as given, one for each option; empty if it was not

    OutputPaths given() const;
    bool isByRanks(const Scene& scene, const Communicator& ranks) const;
  };
  std::vector<Output> outputs_;
};

}  // namespace weir::app
