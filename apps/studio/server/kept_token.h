// A token that outlives a restart: a studio that serves the same folder at the same port is known to pages
// that are open.
#pragma once

#include <filesystem>
#include <string>

namespace weir::studio {

/// What a token belongs to.
struct TokenOwner {
  std::filesystem::path served;  ///< the folder that is served; any spelling of it
  std::string host;
  int port = 0;
};

struct KeptToken {
  std::string token;
  std::string
      problem;  ///< why it will not be known again, or could not be taken up; empty if nothing is wrong
};

/// $XDG_STATE_HOME/weir/studio, or ~/.local/state/weir/studio; empty where there is neither.
std::filesystem::path folderOfTokens();

/// The token that a file of `folder` keeps for the owner, or else, and where `fresh` asks for it, a new one,
/// which is kept. Files have the mode 0600, the folder 0700. A file is not believed, and replaced, if it is a
/// link, belongs to somebody else, can be read or written by others, or is older than 30 days; nothing is
/// kept in a folder that others may write to. For others than this machine, at a port that changes, and
/// without a folder, tokens are always new.
KeptToken keptToken(const std::filesystem::path& folder, const TokenOwner& owner, bool fresh);

}  // namespace weir::studio
