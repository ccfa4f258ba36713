// Calls into code that may be a plugin's: whatever is thrown there becomes an Error that names the plugin.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// The source of what Weir's own libraries register; see Registry::setSource.
inline constexpr std::string_view kOwnSource = "weir";

/// Calls f, which runs code of `source`. If that is a plugin, an Error gains `part()`, such as
/// "module 'lift' (plugin lift)", and any other exception becomes a simulation Error with it; only
/// std::bad_alloc, Interrupted and RanksEnded pass as they are, and all from Weir's own code.
///
/// Errors that name a file say enough by it and pass as they are, if `filesSayEnough`.
void callGuarded(std::string_view source, const std::function<std::string()>& part,
                 const std::function<void()>& f, bool filesSayEnough = false);

/// "step (plugin lift)", or "module 'lift', step (plugin lift)": a hook of `what`, which may be "".
std::string hookText(std::string_view what, std::string_view hook, std::string_view source);

/// What stands behind an interface to files, such as "checkpoints 'hdf5'", and which library it comes from.
struct GuardedPart {
  std::string what, source;

  /// Calls f, which is `hook` of this part, by callGuarded; errors that name a file pass as they are.
  void call(std::string_view hook, const std::function<void()>& f) const;
};

}  // namespace weir
