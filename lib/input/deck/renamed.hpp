#pragma once
// Options that have a new name. The former names stay accepted: decks, command lines and checkpoints may hold
// them.

#include <string>
#include <utility>
#include <vector>

namespace mpm {

/// Former and present names, without dash, of options, or of the part of a name after that of its owner.
std::vector<std::pair<std::string, std::string>> renamed_options();

/// The name of an option today, with its dash: that given, unless it is a former name. A name may begin with
/// a prefix or with the name of a body (-plate_contact_penalty).
std::string present_name(const std::string& name);

}  // namespace mpm
