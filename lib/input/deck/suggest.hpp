#pragma once
// Suggestions for an option that does not exist: names of options that the user may have meant.

#include <string>
#include <vector>

namespace mpm {

/// The known name that is most like `name`, by letters and by words between underscores. For an option of a
/// material, a body or another named thing, it is an option of the same thing. There must be a known name.
std::string most_like(const std::string& name, const std::vector<std::string>& known,
                      const std::vector<std::string>& owners);

/// Why no option of that meaning exists, with the page that says more: of flow of water, contact of
/// deformable bodies, rotation of rigid bodies. Empty for other names. All names are in lower case.
std::string why_none(const std::string& name, const std::vector<std::string>& bodies,
                     const std::vector<std::string>& rigids);

}  // namespace mpm
