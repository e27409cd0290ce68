#pragma once

namespace mpm {

struct UmatCall;
struct UmatLibrary;

/// Code of the user that a thread is running.
struct RunningUmat {
  const UmatLibrary* library = nullptr;
  const UmatCall* call = nullptr;  // null while the library is being loaded
  int step = 0;                    // from 1 on
};

/// Watches code of the user in its scope. Where the code ends the program, the program does not end with the
/// code's status, which may be 0, but with 2 before the first step and 3 after it, and reports this on
/// stderr. Another rank of a run is then ended by its launcher.
class WatchedUmat {
 public:
  explicit WatchedUmat(const RunningUmat& running);
  ~WatchedUmat();
  WatchedUmat(const WatchedUmat&) = delete;
  WatchedUmat& operator=(const WatchedUmat&) = delete;

 private:
  RunningUmat before_;
};

}  // namespace mpm
