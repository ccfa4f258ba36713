#include "apps/weir/describe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/base/build_info.h"
#include "framework/base/text.h"
#include "framework/compute/device.h"
#include "framework/graph/type_values.h"
#include "framework/run/info_source.h"

namespace weir::app {

namespace {

template <class Types>
std::string typeTable(const Types& types) {
  std::size_t width = 0;
  for (const auto& [name, type] : types) width = std::max(width, name.size());
  std::string text;
  for (const auto& [name, type] : types)
    text += fmt::format("  {:<{}}  {}\n", name, width, wrapped(type.info.doc, width + 4));
  return text;
}

std::string rangeOf(const ParamSpec& spec) {
  const bool low = std::isfinite(spec.min), high = std::isfinite(spec.max);
  if (low && high) return fmt::format("{} {} to {}", spec.aboveMin ? "above" : "from", spec.min, spec.max);
  if (low) return fmt::format("{} {}", spec.aboveMin ? "above" : "at least", spec.min);
  if (high) return fmt::format("at most {}", spec.max);
  return {};
}

std::string oneLine(const Value& value) {
  std::string text = writeJson(value);
  std::string line;
  for (const char c : text)
    if (c != '\n') line += c;
  return line;
}

void describeParameters(const Configurable& owner, std::size_t indent, std::string& text) {
  const std::string margin(indent, ' ');
  for (const Property* property : owner.properties()) {
    const ParamSpec& spec = property->spec();
    std::string facts{property->kind()};
    if (!spec.unit.empty()) facts += fmt::format(" [{}]", spec.unit);
    if (const std::string range = rangeOf(spec); !range.empty()) facts += ", " + range;
    if (property->group() == nullptr) facts += ", default " + oneLine(property->defaultValue());
    if (!spec.onlyFor.empty()) facts += fmt::format(", only for {}", spec.onlyFor);
    if (spec.live) facts += ", may change during a run";
    if (spec.animated) facts += ", may be keyframes";
    text += fmt::format("{}{}: {}\n{}    {}\n", margin, property->name(), facts, margin,
                        wrapped(spec.doc, indent + 4));
    for (const EnumName& choice : property->choices())
      text += fmt::format("{}      {}: {}\n", margin, choice.first, wrapped(choice.second, indent + 8));
    if (property->group() != nullptr) describeParameters(*property->group(), indent + 4, text);
  }
}

/// The modules of a pipeline, and the registered ones of its family that it does without.
void describePipeline(const Registry& registry, const PipelineBase& pipeline, std::string& text) {
  text += fmt::format("\nModules (of the family {})\n", pipeline.family());
  std::set<std::string_view> present;
  for (const auto& module : pipeline.modules()) {
    present.insert(module->info().type);
    text += fmt::format("  {}: {}{}\n      {}\n", module->name(), module->info().type,
                        module->enabled() ? "" : " (disabled)", wrapped(module->info().doc, 6));
  }
  std::string others;
  for (const auto& [name, type] : registry.modules())
    if (type.info.family == pipeline.family() && !present.contains(type.info.type))
      others += fmt::format("  {}\n      {}\n", name, wrapped(type.info.doc, 6));
  if (!others.empty()) text += "\nModules that may replace these or be inserted\n" + others;
}

void describeNode(const Registry& registry, const Registry::NodeType& type, std::string& text) {
  const std::unique_ptr<Node> node = registry.createNode(type.info.type);
  text += fmt::format("{} (node, from {})\n  {}\n", type.info.type, type.source, wrapped(type.info.doc, 2));
  if (!node->inputs().empty()) text += "\nInputs\n";
  for (const InputPort* input : node->inputs())
    text += fmt::format("  {}: {}, {}{}\n      {}\n", input->name(), input->typeName(),
                        input->many() ? "any number of links" : "one link",
                        input->required() ? ", required" : "", wrapped(input->doc(), 6));
  if (!node->outputs().empty()) text += "\nOutputs\n";
  for (const OutputPort* output : node->outputs())
    text +=
        fmt::format("  {}: {}\n      {}\n", output->name(), output->typeName(), wrapped(output->doc(), 6));
  if (!node->properties().empty()) text += "\nParameters\n";
  describeParameters(*node, 2, text);
  if (const PipelineBase* pipeline = node->pipeline()) describePipeline(registry, *pipeline, text);
}

void describeModule(const Registry& registry, const Registry::ModuleType& type, std::string& text) {
  const std::unique_ptr<Module> module = registry.createModule(type.info.type);
  text += fmt::format("{} (module of the family {}, from {})\n  {}\n", type.info.type, type.info.family,
                      type.source, wrapped(type.info.doc, 2));
  if (!module->properties().empty()) text += "\nParameters\n";
  describeParameters(*module, 2, text);
}

Error unknownType(const Registry& registry, const std::string& type) {
  std::vector<std::string> names;
  for (const auto& [name, node] : registry.nodes()) names.push_back(name);
  for (const auto& [name, module] : registry.modules()) names.push_back(name);
  return usageError("there is no node or module type " + inQuotes(type), joinNames(names),
                    didYouMean(type, names));
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t indent) {
  constexpr std::size_t kWidth = 100;
  std::string result;
  std::size_t column = indent;
  while (!text.empty()) {
    const std::size_t space = std::min(text.find(' '), text.size());
    const bool breaks = column > indent && column + 1 + space > kWidth;
    if (breaks) {
      result += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      result += ' ';
      ++column;
    }
    result += text.substr(0, space);
    column += space;
    text.remove_prefix(std::min(space + 1, text.size()));
  }
  return result;
}

std::string describeAll(const Registry& registry) {
  return "Nodes\n" + typeTable(registry.nodes()) + "\nModules\n" + typeTable(registry.modules()) +
         "\n'weir nodes TYPE' tells more of one.\n";
}

std::string describeType(const Registry& registry, const std::string& type) {
  std::string text;
  const auto node = registry.nodes().find(type);
  const auto module = registry.modules().find(type);
  if (node != registry.nodes().end()) describeNode(registry, node->second, text);
  if (module != registry.modules().end()) describeModule(registry, module->second, text);
  if (text.empty()) throw unknownType(registry, type);
  return text;
}

Value typesAsValue(const Registry& registry, const std::string& type) {
  Value nodes = Value::object(), modules = Value::object();
  for (const auto& [name, node] : registry.nodes())
    if (type.empty() || name == type) nodes[name] = typeAsValue(registry, node);
  for (const auto& [name, module] : registry.modules())
    if (type.empty() || name == type) modules[name] = typeAsValue(registry, module);
  if (nodes.asObject().empty() && modules.asObject().empty()) throw unknownType(registry, type);
  Value all = Value::object();
  all["nodes"] = std::move(nodes);
  all["modules"] = std::move(modules);
  if (type.empty()) {
    all["world"] = parametersAsValue(World());
    Value& sections = all["sections"] = Value::object();
    for (const auto& [name, section] : registry.sections())
      sections[name] = parametersAsValue(*section.create());
  }
  return all;
}

std::string describeProgram(const Program& program, const Registry& registry) {
  std::string text =
      fmt::format("weir {} ({}, {})\n  CUDA: {}\n", version(), buildType(), compilerName(), cudaBuildInfo());
  text += "\nDevices\n";
  for (const DeviceInfo& device : listDevices())
    text += fmt::format("  {}: {}\n", device.name, device.description);
  text += "\nPlugins\n";
  if (program.plugins().empty()) text += "  none\n";
  for (const Plugin& plugin : program.plugins())
    text +=
        fmt::format("  {}: {}{}\n      {}\n", plugin.name(), plugin.doc(),
                    builtWithCuda() && !plugin.hasCudaKernels() ? " (Built without kernels for CUDA.)" : "",
                    plugin.file().string());
  text += "  searched in:\n";
  for (const auto& folder : pluginFolders()) text += fmt::format("      {}\n", folder.string());
  for (const auto& [name, info, source] : registry.createServices<InfoSource>()) {
    text += fmt::format("\n{}\n", name);
    const auto where = [&] { return hookText("information " + inQuotes(name), "info", source); };
    callGuarded(source, where, [&] {
      for (const InfoEntry& entry : info->info()) text += fmt::format("  {}: {}\n", entry.name, entry.text);
    });
  }
  return text;
}

}  // namespace weir::app
