#include "app/commands/interrupt.h"

#include <csignal>

#include "core/base/platform.h"

namespace app {
namespace {

volatile std::sig_atomic_t noted = 0;

extern "C" void note(int) { noted = 1; }

} // namespace

void catch_interrupts() {
    core::platform::catch_interrupts(core::platform::Interrupts::keys, note);
}

bool was_interrupted() { return noted != 0; }

void clear_interrupt() { noted = 0; }

} // namespace app
