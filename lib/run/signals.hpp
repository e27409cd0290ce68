#pragma once
// Signals that stop a run: SIGTERM, SIGINT and SIGUSR1, as batch systems and users send them before a limit.
// The first one asks the run to write a checkpoint and end; a second one ends the program at once, as if it
// had never been caught.

namespace mpm {

/// From now on the first of the signals is only noted. A file that grows beyond what the system lets this
/// process write (SIGXFSZ) fails by its call in lieu of ending the program.
void catch_signals();

/// While one lives a second signal ends nothing: what is being written is the very thing that the first has
/// asked for.
class SignalsWait {
 public:
  SignalsWait();
  SignalsWait(const SignalsWait&) = delete;
  SignalsWait& operator=(const SignalsWait&) = delete;
  ~SignalsWait();
};

/// From now on to the end of the program none of the signals does anything: the run is stopping, and its last
/// checkpoint is being written.
void ignore_signals();

/// The signal that came, 0 for none.
int signal_caught();

/// "SIGTERM" and so on.
const char* name_of_signal(int signal);

}  // namespace mpm
