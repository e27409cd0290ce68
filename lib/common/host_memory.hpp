#pragma once
// The memory of the host.

namespace mpm {

/// Bytes of the host's memory that are free for this process; 0 where the system does not report them.
double free_host_memory();

}  // namespace mpm
