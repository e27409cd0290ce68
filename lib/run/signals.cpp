#include "run/signals.hpp"

#include <csignal>
#include <ctime>

namespace mpm {
namespace {

constexpr int k_signals[] = {SIGTERM, SIGINT, SIGUSR1};

// Variables of the handler, which have to be global.
volatile std::sig_atomic_t caught = 0, waiting = 0;
struct timespec caught_at;

/// s since the first signal.
double seconds_since() {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec - caught_at.tv_sec) + 1e-9 * (now.tv_nsec - caught_at.tv_nsec);
}

void note(int signal) {
  // A launcher and a batch system may both pass one signal on: what comes so soon is the same one.
  constexpr double k_same = 0.05;  // s
  if (caught == 0) {
    clock_gettime(CLOCK_MONOTONIC, &caught_at);
    caught = signal;
  } else if (waiting == 0 && seconds_since() > k_same) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

}  // namespace

void catch_signals() {
  struct sigaction action = {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (const int signal : k_signals) sigaction(signal, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
}

void ignore_signals() {
  for (const int signal : k_signals) std::signal(signal, SIG_IGN);
}

SignalsWait::SignalsWait() { waiting = waiting + 1; }
SignalsWait::~SignalsWait() { waiting = waiting - 1; }

int signal_caught() { return caught; }

const char* name_of_signal(int signal) {
  return signal == SIGTERM ? "SIGTERM" : signal == SIGINT ? "SIGINT" : "SIGUSR1";
}

}  // namespace mpm
