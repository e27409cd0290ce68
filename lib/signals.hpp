#pragma once
// Being told to stop: SIGTERM, SIGINT and SIGUSR1, as batch systems and users send them before a time limit.
// The first one asks the run to write a checkpoint and end; a second one ends the program at once, as if it
// had never been caught.

namespace mpm {

/// From now on the first of the signals is only noted.
void catch_signals();

/// The signal that came, 0 for none.
int signal_caught();

/// "SIGTERM" and so on.
const char* name_of_signal(int signal);

}  // namespace mpm
