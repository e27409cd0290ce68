#pragma once
// The measurement cache: figures that cost time to measure, kept for the next run in the user's cache folder.

#include <functional>
#include <string>

namespace mpm {

/// The number kept under `key`, or what `measure` gives, which is kept then (not if it is 0). The file is
/// mpm/NAME in $XDG_CACHE_HOME, or in ~/.cache: a line a key, which may be deleted to have it measured again.
/// Without a folder that can be written it is measured every time.
double cached_measurement(const std::string& name, const std::string& key,
                          const std::function<double()>& measure);

}  // namespace mpm
