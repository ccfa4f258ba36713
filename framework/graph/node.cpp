#include "framework/graph/node.h"

namespace weir {

namespace {
template <class P>
P* findByName(const std::vector<P*>& ports, std::string_view name) {
  for (P* port : ports)
    if (port->name() == name) return port;
  return nullptr;
}
}  // namespace

InputPort* Node::findInput(std::string_view name) const {
  return findByName(inputs_, name);
}

OutputPort* Node::findOutput(std::string_view name) const {
  return findByName(outputs_, name);
}

}  // namespace weir
