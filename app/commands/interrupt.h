#pragma once

namespace app {

/// From now on an interrupt (Ctrl-C) is noted and ends nothing.
void note_interrupts();

/// Whether there was one since the last call of forget_interrupt.
bool was_interrupted();
void forget_interrupt();

} // namespace app
