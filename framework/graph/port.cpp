#include "framework/graph/port.h"

#include <algorithm>

#include "framework/graph/node.h"

namespace weir {

std::string Port::path() const {
  return node_.name() + "." + name_;
}

OutputPort::OutputPort(Node& node, std::string_view name, std::string_view typeName, std::string_view doc)
    : Port(node, name, typeName, doc) {
  WEIR_CHECK(node.findOutput(name) == nullptr);
  node.outputs_.push_back(this);
}

InputPort::InputPort(Node& node, std::string_view name, std::string_view typeName, std::string_view doc,
                     bool required, bool many)
    : Port(node, name, typeName, doc), required_(required), many_(many) {
  WEIR_CHECK(node.findInput(name) == nullptr);
  node.inputs_.push_back(this);
}

void InputPort::link(OutputPort& from) {
  const std::string ends = "'" + from.path() + "' and '" + path() + "'";
  if (from.typeName() != typeName())
    throw sceneError(
        ends + " do not fit: the output is a " + from.typeName() + ", the input takes a " + typeName(),
        "a link between ports of one type");
  if (std::find(links_.begin(), links_.end(), &from) != links_.end())
    throw sceneError(ends + " are linked twice", "one link between two ports");
  if (!many_ && !links_.empty())
    throw sceneError("'" + path() + "' is linked to '" + links_.front()->path() +
                         "' already, and again to '" + from.path() + "'",
                     "one link into this input");
  // In the order of the nodes, so that a scene means the same however they are called and links are listed.
  const auto place = [](const OutputPort* port) { return std::pair(port->node().place(), port->name()); };
  links_.insert(
      std::upper_bound(links_.begin(), links_.end(), &from,
                       [&](const OutputPort* a, const OutputPort* b) { return place(a) < place(b); }),
      &from);
  from.links_.push_back(this);
}

void InputPort::unlink(OutputPort& from) {
  std::erase(links_, &from);
  std::erase(from.links_, this);
}

}  // namespace weir
