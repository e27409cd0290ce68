#pragma once
// -analysis: the kind of the job, which sets the defaults of the options that say how particles follow the
// soil.

#include <string>

#include "input/options/reader.hpp"

namespace mpm {

/// Reads -analysis and puts its defaults into `config`. Values of the deck are read later and prevail.
void read_analysis(OptionReader& in, Config& config);

/// Notes in one line of the log which defaults -analysis has set, and which options the deck gives itself.
/// `config` holds the values in force.
void note_analysis(OptionReader& in, const Config& config);

/// Whether an option that the deck does not give has its default by -analysis flow.
bool set_by_flow(const OptionReader& in, const Config& config, const std::string& name);

}  // namespace mpm
