#pragma once

namespace app {

/// From now on Ctrl-C only sets a flag.
void note_interrupts();

/// Whether Ctrl-C was pressed since the last call of forget_interrupt.
bool was_interrupted();
void forget_interrupt();

} // namespace app
