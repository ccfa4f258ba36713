// A scene in sentences: what it is made of, what flows where, and how much of it there will be.
#pragma once

#include <string>

#include "framework/graph/memory_estimate.h"
#include "framework/run/simulation.h"

namespace weir::app {

/// "It simulates 4 s in 120 frames, 30 a second. …": the time and the steps.
std::string explainTime(const Simulation& simulation);
/// Each type of node, with the names of its nodes.
std::string explainNodes(const SceneGraph& graph);
/// What each link is for; those of one input together.
std::string explainLinks(const SceneGraph& graph);
/// `available` memory of the device in bytes, or 0.
std::string explainMemory(const MemoryEstimate& estimate, const std::string& device, double available);

}  // namespace weir::app
