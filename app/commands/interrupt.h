#pragma once

namespace app {

/// From now on Ctrl-C only sets a flag.
void note_interrupts();

/// Whether there was one since the last call of forget_interrupt.
bool was_interrupted();
void forget_interrupt();

} // namespace app
