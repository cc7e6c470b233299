#include "app/commands/interrupt.h"

#include <csignal>

namespace app {
namespace {

volatile std::sig_atomic_t noted = 0;

extern "C" void note(int) { noted = 1; }

} // namespace

void catch_interrupts() { std::signal(SIGINT, note); }

bool was_interrupted() { return noted != 0; }

void clear_interrupt() { noted = 0; }

} // namespace app
